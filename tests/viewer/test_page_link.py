import asyncio
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from course_lib.viewer import page_link
from course_lib.viewer.drawables import Solids
from course_lib.viewer.page_link import Click
from tests.viewer.page_wire import Wire

RED_BOX = Solids("box", [np.eye(4)], (1, 0, 0, 1))
IN_FLIGHT = page_link._MAX_PENDING_ACKS * page_link._ACK_BATCHES  # that a page may leave unanswered
MANY = 3 * IN_FLIGHT


def until(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + 60  # [s]
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.mark.usefixtures("by_hand")
def test_page_receives_no_more_than_the_limit_of_unacknowledged_batches(wire: Wire) -> None:
    wire.hear("ready")
    wire.change(100)
    assert wire.kinds() == ["batch"] * IN_FLIGHT
    assert len(wire.link._moved_paths) == 1
    wire.hear("ack")
    wire.change()
    assert len(wire.sent) == IN_FLIGHT + 1


@pytest.mark.usefixtures("by_hand")
def test_slowest_page_determines_the_rate(wire: Wire) -> None:
    wire.hear("ready", "a")
    wire.hear("ready", "b")
    wire.change(100)
    wire.hear("ack", "a")
    wire.change(100)
    assert len(wire.sent) == IN_FLIGHT
    wire.hear("views", "b", count=0)
    wire.change()
    assert len(wire.sent) == IN_FLIGHT + 1


@pytest.mark.usefixtures("by_hand")
def test_fastest_visible_page_determines_the_interval(wire: Wire) -> None:
    intervals = []
    for page, kind, fields in (
        ("a", "ready", {}),
        ("a", "ack", {"drawing": 0.1}),
        ("b", "ready", {}),
        ("b", "ack", {"drawing": 0.2}),
        ("a", "hide", {}),
        ("b", "ack", {"drawing": 60.0}),
        ("b", "ack", {}),
    ):
        wire.hear(kind, page, **fields)
        intervals.append(wire.link.interval)
    fast, slowest = page_link.INTERVAL, page_link.MAX_INTERVAL
    assert intervals == [fast, 0.1, fast, 0.1, 0.2, slowest, fast]


@pytest.mark.usefixtures("by_hand")
def test_large_batches_are_acknowledged_one_by_one(wire: Wire) -> None:
    wire.hear("ready")
    for number in range(10):
        many = Solids("box", np.tile(np.eye(4), (8000, 1, 1)), (number / 10, 0, 0, 1))
        wire.scene.set_object("boxes", many)
        wire.link.flush()
    assert [content["ask"] for content in wire.sent] == [True] * page_link._MAX_PENDING_ACKS


def test_unresponsive_page_is_considered_closed(wire: Wire, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page_link, "MAX_SILENCE", 0.1)
    counts: list[int] = []
    wire.link.on_views = counts.append
    wire.hear("ready")
    assert wire.link.is_ready

    def is_gone() -> bool:
        wire.change()
        return not wire.link.is_ready

    until(is_gone)
    assert counts == [0]
    wire.sent.clear()
    wire.change(3)
    assert wire.sent == []
    wire.hear("ack", number=IN_FLIGHT)  # it was only asleep
    assert wire.link.is_ready
    assert wire.kinds() == ["reset"]


def test_closed_page_is_detected_by_missing_acknowledgements(
    wire: Wire, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A closed page, taken for open, would get the time for ever, and its kernel would never be idle."""
    wire.hear("ready")

    for _ in range(3 * IN_FLIGHT):
        wire.link.post({"type": "time"})
        if "ask" in wire.sent[-1]:
            wire.hear("ack")
    assert wire.link.is_ready
    monkeypatch.setattr(page_link, "MAX_SILENCE", 0.1)

    def is_gone() -> bool:
        wire.link.post({"type": "time"})
        return not wire.link.is_ready

    until(is_gone)


@pytest.mark.usefixtures("by_hand")
def test_running_cell_is_not_blocked_by_missing_acknowledgements(monkeypatch: pytest.MonkeyPatch) -> None:
    async def cell() -> None:
        wire = Wire()
        wire.hear("ready")
        wire.change(MANY)  # without giving the loop a chance
        assert len(wire.sent) == MANY
        await asyncio.sleep(0.01)
        wire.change(MANY)
        assert len(wire.sent) == MANY
        await asyncio.to_thread(wire.hear, "ack")  # as in JupyterLab
        await asyncio.sleep(0.01)
        wire.change(MANY)
        assert len(wire.sent) == MANY + IN_FLIGHT

    asyncio.run(cell())


@pytest.mark.usefixtures("by_hand")
def test_views_are_counted_over_all_pages(wire: Wire) -> None:
    counts: list[int] = []
    wire.link.on_views = counts.append
    for page, count in (("a", 1), ("b", 2), ("a", 0), ("b", 0)):
        wire.hear("views", page, count=count)
    assert counts == [1, 3, 2, 0]
    assert not wire.link.is_ready


@pytest.mark.usefixtures("by_hand")
def test_only_the_page_that_lost_a_batch_receives_the_complete_scene_again(wire: Wire) -> None:
    wire.hear("ready", "a")
    wire.hear("ready", "b")
    wire.hear("resync", "b")
    assert wire.sent == [{"type": "reset", "number": 0, "page": "b"}]


@pytest.mark.parametrize("error", [KeyboardInterrupt(), ValueError("half way")])
def test_interrupted_scene_update_is_sent_again_with_a_notice(wire: Wire, error: BaseException) -> None:
    wire.hear("ready")
    wire.fails = error
    wire.scene.set_object("box", RED_BOX)
    with pytest.raises(type(error)):
        wire.link.flush()
    until(lambda: wire.kinds()[:2] == ["reset", "status"])
    assert "sent again" in wire.sent[1]["text"]
    wire.change()
    assert wire.kinds()[-1] == "batch"


def test_failing_connection_stops_only_the_sending(wire: Wire, capsys: pytest.CaptureFixture[str]) -> None:
    wire.hear("ready")
    wire.fails = ConnectionError("closed")
    wire.scene.set_object("box", RED_BOX)
    message = ""

    def is_said() -> bool:
        nonlocal message
        message += capsys.readouterr().err
        return "is no longer connected to its scene: ConnectionError('closed')" in message

    until(is_said)
    wire.change(3)
    assert wire.sent == []
    wire.hear("resync", number=0)
    wire.hear("ready", "another", number=0)
    assert wire.kinds()[-1] == "reset"


@pytest.mark.parametrize(
    "content",
    [
        {},
        {"type": "views"},
        {"type": "views", "count": "many"},
        {"type": "ready", "number": "first"},
        {"type": "click"},
        {"type": "click", "origin": 3},
        {"type": "ack", "drawing": "slow"},
    ],
)
def test_invalid_page_message_is_reported_in_the_views(wire: Wire, content: dict[str, Any]) -> None:
    wire.link.receive({"page": "a", **content})
    assert wire.kinds()[-1] == "status"
    assert "was ignored" in wire.sent[-1]["text"]


def test_unknown_message_kind_is_ignored(wire: Wire) -> None:
    wire.hear("format_disk")
    assert wire.sent == []


def test_other_message_types_are_passed_to_their_listeners(wire: Wire) -> None:
    received: list[dict[str, Any]] = []
    wire.link.listen("edit", received.append)
    wire.hear("edit", number=0, row=3)
    wire.link.post({"type": "rows", "rows": []})
    assert received == [{"type": "edit", "page": "a", "number": 0, "row": 3}]
    assert wire.kinds() == ["rows"]


def test_click_callback_runs_in_the_thread_of_the_cells() -> None:
    async def cell() -> list[tuple[Click, bool]]:
        wire, clicks = Wire(), []
        wire.link.on_click.append(
            lambda click: clicks.append((click, threading.current_thread() is threading.main_thread()))
        )
        fields = {"origin": [0, 0, 1], "direction": [0, 0, -1], "path": "box", "type": "click", "page": "a"}
        await asyncio.to_thread(wire.link.receive, fields)
        await asyncio.sleep(0.01)
        return clicks

    click = Click(origin=(0, 0, 1), direction=(0, 0, -1), path="box")
    assert asyncio.run(cell()) == [(click, True)]
