"""Invisible pages: in background tabs, or with their views scrolled out of sight."""

import time

import pytest

from course_lib.viewer import page_link
from tests.viewer.page_wire import Wire


@pytest.mark.usefixtures("by_hand")
@pytest.mark.parametrize("sight", ["hide", "away"])
def test_hidden_page_receives_the_whole_scene_when_it_is_visible_again(sight: str, wire: Wire) -> None:
    wire.hear("ready")
    wire.hear(sight)
    wire.change(100)
    wire.hear("ack")  # for its earlier batches
    wire.change()
    assert (wire.sent, wire.link.is_watched) == ([], False)
    wire.hear("ready", number=0)
    wire.change()
    assert (wire.kinds(), wire.link.is_watched) == (["reset", "batch"], True)


def test_background_page_is_ready_only_with_offscreen_views(wire: Wire) -> None:
    answers = {}
    for sight in ("ready", "away", "hide"):
        wire.hear(sight)
        answers[sight] = wire.link.is_ready, wire.link.is_watched, wire.link.is_hidden
    assert answers == {
        "ready": (True, True, False),
        "away": (True, False, False),
        "hide": (False, False, True),
    }


@pytest.mark.usefixtures("by_hand")
def test_scene_is_sent_while_one_of_two_pages_is_visible(wire: Wire) -> None:
    for page in ("a", "b"):
        wire.hear("ready", page)
    wire.hear("away", "a")
    wire.change()
    assert (wire.kinds(), wire.link.is_watched) == (["batch"], True)
    wire.hear("hide", "b")
    wire.change()
    assert (wire.kinds(), wire.link.is_watched) == (["batch"], False)


@pytest.mark.usefixtures("by_hand")
def test_hidden_page_is_updated_before_it_draws_an_image(wire: Wire) -> None:
    wire.hear("ready")
    wire.hear("away")
    wire.change()
    wire.link.send_all()
    assert wire.kinds() == ["reset"]
    wire.change()
    wire.hear("ready", number=wire.sent[0]["number"])
    assert wire.kinds() == ["reset", "reset"]  # the change after it is not lost


@pytest.mark.usefixtures("by_hand")
def test_hidden_page_of_an_unchanged_scene_receives_no_update_when_visible_again(wire: Wire) -> None:
    wire.hear("ready")
    wire.change()
    wire.hear("hide")
    wire.hear("ready")
    wire.change()
    assert wire.kinds() == ["batch", "batch"]


def test_sleeping_hidden_page_is_not_considered_closed(wire: Wire, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(page_link, "MAX_SILENCE", 0.1)
    counts: list[int] = []
    wire.link.on_views = counts.append
    wire.hear("ready", "a")
    wire.change(100)  # more than it answers
    wire.hear("hide", "a")
    time.sleep(0.5)
    assert counts == []


@pytest.mark.usefixtures("by_hand")
def test_hidden_page_does_not_block_other_pages(wire: Wire) -> None:
    wire.hear("ready", "a")
    wire.hear("hide", "a")
    wire.hear("ready", "b")
    for _ in range(50):
        wire.change()
        wire.hear("ack", "b")
    assert wire.kinds() == ["batch"] * 50
