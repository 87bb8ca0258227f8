from typing import Any

import pytest

from course_lib.displays.frames import ViewTime
from course_lib.displays.panel.panels import LiveTime, Playback, TimeChange, TimePanel
from course_lib.displays.session import RvizSession
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time.pace import speed_of
from course_lib.viewer.page_link import PageLink
from course_lib.viewer.scene import Scene


def test_page_requests_change_the_speed_of_robot_time() -> None:
    graph = Graph()
    live, speed = LiveTime(graph, ViewTime(0, False)), speed_of(graph)
    live.act(TimeChange(rate=0.5, paused=False))
    assert speed.advance_ns(1.0) == 500_000_000
    live.act(TimeChange(step=1))
    assert (speed.is_paused, speed.advance_ns(1.0), speed.advance_ns(1.0)) == (True, 100_000_000, 0)
    live.act(TimeChange(paused=False))
    assert speed.advance_ns(1.0) == 500_000_000


class Page:
    """A page with a time bar, which stores the messages to it."""

    def __init__(self, session: RvizSession, source: LiveTime | Playback) -> None:
        self.told: list[dict[str, Any]] = []
        self._link = PageLink(session.context.scene, lambda content, _: self.told.append(content))
        self.panel = TimePanel(session, self._link, source)

    def send(self, **change: Any) -> dict[str, Any]:
        self._link.receive({"type": "time", "page": "a", "number": 0, **change})
        return self.told[-1]


@pytest.mark.parametrize("change", [{"rate": 0}, {"rate": -2}, {"step": 9}], ids=str)
def test_out_of_range_time_change_is_ignored(change: dict[str, Any]) -> None:
    graph = Graph()
    assert "note" not in Page(RvizSession(Scene()), LiveTime(graph, ViewTime(0, False))).send(**change)
    assert speed_of(graph).advance_ns(1.0) == 10**9


@pytest.mark.parametrize(
    "change", [{"rate": float("nan")}, {"rate": "fast"}, {"step": 0.5}, {"paused": 1}, {"speed": 2}], ids=str
)
def test_malformed_time_change_is_rejected_with_a_notice(change: dict[str, Any]) -> None:
    graph = Graph()
    note = Page(RvizSession(Scene()), LiveTime(graph, ViewTime(0, False))).send(**change)["note"]
    assert next(iter(change)) in note
    assert speed_of(graph).advance_ns(1.0) == 10**9


def test_every_page_request_is_answered_with_the_current_time() -> None:
    session, graph = RvizSession(Scene()), Graph()
    page = Page(session, LiveTime(graph, session.time))
    times = [page.send(), page.send(paused=True)]
    assert [time["paused"] for time in times] == [False, True]
    assert times[0]["now"] == 1_700_000_000
    page.panel.close()
    assert session.after_frame == []
