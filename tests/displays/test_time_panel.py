from typing import Any

import pytest

from course_lib.displays.session import Session
from course_lib.displays.time_panel import LiveTime, TimePanel
from course_lib.ros.graph import Graph
from course_lib.ros.pace import speed_of
from course_lib.viewer.page_link import PageLink
from course_lib.viewer.scene import Scene


def test_orders_of_a_page_reach_the_speed_of_robot_time() -> None:
    graph = Graph()
    live, speed = LiveTime(graph), speed_of(graph)
    live.act({"rate": 0.5, "paused": False})
    assert speed.passed_ns(1.0) == 500_000_000
    live.act({"step": 1})
    assert (speed.paused, speed.passed_ns(1.0), speed.passed_ns(1.0)) == (True, 100_000_000, 0)
    live.act({"paused": False})
    assert speed.passed_ns(1.0) == 500_000_000


@pytest.mark.parametrize(
    "nonsense", [{"rate": 0}, {"rate": -2}, {"rate": float("nan")}, {"rate": "fast"}, {"step": 9}]
)
def test_nonsense_changes_nothing(nonsense: dict[str, Any]) -> None:
    graph = Graph()
    LiveTime(graph).act(nonsense)
    assert speed_of(graph).passed_ns(1.0) == 10**9


def test_a_page_that_asks_is_told_the_time_and_every_order_is_answered() -> None:
    told: list[dict[str, Any]] = []
    session, graph = Session(Scene()), Graph()
    link = PageLink(session.context.scene, lambda content, _: told.append(content))
    panel = TimePanel(session, link, LiveTime(graph))
    for message in ({}, {"paused": True}):
        link.receive({"type": "time", "page": "a", "number": 0, **message})
    times = [content for content in told if content["type"] == "time"]
    assert [time["paused"] for time in times] == [False, True]
    assert times[0]["now"] == 1_700_000_000
    panel.close()
    assert session.after_frame == []
