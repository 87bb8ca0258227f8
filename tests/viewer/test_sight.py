"""Pages that nobody sees: behind other tabs, or with their views scrolled out of sight."""

import time

import pytest

from course_lib.viewer import stream
from tests.viewer.page_wire import Wire


@pytest.mark.usefixtures("by_hand")
@pytest.mark.parametrize("sight", ["hide", "away"])
def test_a_page_that_nobody_sees_gets_nothing_and_when_it_is_seen_again_the_whole_scene(
    sight: str, wire: Wire
) -> None:
    wire.hear("ready")
    wire.hear(sight)
    wire.change(100)
    wire.hear("ack")  # for what it had got before
    wire.change()
    assert (wire.sent, wire.link.watched) == ([], False)
    wire.hear("ready", number=0)
    wire.change()
    assert (wire.kinds(), wire.link.watched) == (["reset", "batch"], True)


def test_a_page_behind_others_is_not_ready_and_one_whose_views_are_out_of_sight_is(wire: Wire) -> None:
    answers = {}
    for sight in ("ready", "away", "hide"):
        wire.hear(sight)
        answers[sight] = wire.link.ready, wire.link.watched, wire.link.hidden
    assert answers == {
        "ready": (True, True, False),
        "away": (True, False, False),
        "hide": (False, False, True),
    }


@pytest.mark.usefixtures("by_hand")
def test_a_scene_is_sent_as_long_as_one_page_of_two_sees_it(wire: Wire) -> None:
    for page in ("a", "b"):
        wire.hear("ready", page)
    wire.hear("away", "a")
    wire.change()
    assert (wire.kinds(), wire.link.watched) == (["batch"], True)
    wire.hear("hide", "b")
    wire.change()
    assert (wire.kinds(), wire.link.watched) == (["batch"], False)


@pytest.mark.usefixtures("by_hand")
def test_a_page_out_of_sight_catches_up_when_it_shall_draw_a_picture(wire: Wire) -> None:
    wire.hear("ready")
    wire.hear("away")
    wire.change()
    wire.link.catch_up()
    assert wire.kinds() == ["reset"]
    wire.change()
    wire.hear("ready", number=wire.sent[0]["number"])
    assert wire.kinds() == ["reset", "reset"]  # the change after it is not lost


@pytest.mark.usefixtures("by_hand")
def test_a_hidden_page_whose_scene_stands_still_gets_nothing_when_it_is_seen_again(wire: Wire) -> None:
    wire.hear("ready")
    wire.change()
    wire.hear("hide")
    wire.hear("ready")
    wire.change()
    assert wire.kinds() == ["batch", "batch"]


def test_a_hidden_page_that_sleeps_is_not_taken_for_gone(wire: Wire, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream, "LONGEST_SILENCE", 0.1)
    counts: list[int] = []
    wire.link.on_views = counts.append
    wire.hear("ready", "a")
    wire.change(100)  # more than it answers
    wire.hear("hide", "a")
    time.sleep(0.5)
    assert counts == []


@pytest.mark.usefixtures("by_hand")
def test_nobody_waits_for_a_hidden_page(wire: Wire) -> None:
    wire.hear("ready", "a")
    wire.hear("hide", "a")
    wire.hear("ready", "b")
    for _ in range(50):
        wire.change()
        wire.hear("ack", "b")
    assert wire.kinds() == ["batch"] * 50
