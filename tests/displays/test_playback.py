from pathlib import Path
from typing import Any

import pytest

from course_lib.displays.panel.panels import Playback, TimeChange
from course_lib.displays.render import record_bag, replay, session_for
from course_lib.recording import Recording
from course_lib.viewer.html import save_html
from tests.displays.bench import marker
from tests.displays.test_render import COMES_AND_GOES, sample
from tests.displays.test_time_panel import Page
from tests.viewer.test_stream import decoded


@pytest.fixture
def playback() -> Playback:
    return Playback(
        session_for(COMES_AND_GOES), COMES_AND_GOES
    )  # at 0 s a marker, at 1 s another, which is gone at 2 s


def count_visible(playback: Playback) -> int:
    scene = playback.session.context.scene
    return sum("Marker" in path and scene.is_visible(path) for path in scene.objects())


@pytest.mark.parametrize("order", [(0.5, 1.5, 2.0), (2.0, 1.5, 0.5, 1.5), (1.5, 1.2, 1.0, 0.99)])
def test_seeking_shows_the_same_scene_as_a_replay_up_to_that_time(
    playback: Playback, order: tuple[float, ...]
) -> None:
    for seconds in order:
        playback.act(TimeChange(now=seconds))
        expected = replay(COMES_AND_GOES, at=seconds).context.scene.objects().keys()
        assert playback.session.context.scene.objects().keys() == expected
        assert playback.time().elapsed == pytest.approx(seconds)


def test_playback_pauses_at_the_end_until_played_again(playback: Playback) -> None:
    playback.advance(1.5)
    assert count_visible(playback) == 2
    playback.advance(9.0)
    assert count_visible(playback) == 1
    assert (playback.time().elapsed, playback.is_paused) == (2.0, True)
    playback.advance(1.0)
    assert playback.time().elapsed == 2.0
    playback.act(TimeChange(paused=False))
    assert playback.time().elapsed == 0.0


def test_loop_restarts_and_rate_scales_the_playback(playback: Playback) -> None:
    playback.act(TimeChange(loop=True, rate=2))
    playback.advance(1.75)
    assert playback.time().elapsed == pytest.approx(1.5)
    assert count_visible(playback) == 2
    assert not playback.is_paused


def test_step_pauses_the_playback(playback: Playback) -> None:
    playback.act(TimeChange(step=1))
    assert playback.time().elapsed == pytest.approx(1 / 30)
    assert playback.is_paused
    playback.act(TimeChange(step=-3))
    assert playback.time().elapsed == 0.0


@pytest.mark.parametrize(
    "nonsense", [{"now": "x"}, {"now": float("nan")}, {"rate": -1}, {"rate": None}, {"step": "1"}]
)
def test_invalid_playback_requests_are_ignored(playback: Playback, nonsense: dict[str, Any]) -> None:
    before = playback.time()
    Page(playback.session, playback).send(**nonsense)
    assert playback.time() == before


def test_empty_recording_does_not_advance() -> None:
    empty = Recording(())
    playback = Playback(session_for(empty), empty)
    playback.act(TimeChange(loop=True))
    playback.advance(1.0)
    assert playback.time().range == (0.0, 0.0)


def test_scene_recording_of_messages_removes_expired_markers_at_their_time() -> None:
    fading = marker()
    fading.lifetime.sec = 1
    recording, _ = record_bag(Recording([sample("/m", fading), sample("/chatter", marker(), 3.0)]))
    batches = decoded(recording.pack())["batches"]
    gone = [b["time"] for b in batches for c in b.get("commands", []) if c["type"] in ("delete", "visible")]
    assert gone[-1] == pytest.approx(1.0, abs=0.1)


def test_saved_page_of_a_long_recording_stays_small(tmp_path: Path) -> None:
    moving = []
    for number in range(600):
        message = marker()
        message.pose.position.x = number / 100  # [m]
        moving.append(sample("/m", message, number / 30))
    recording, _ = record_bag(Recording(moving))
    assert recording.duration == pytest.approx(599 / 30)
    still = save_html(recording.scene, tmp_path / "still.html").stat().st_size
    assert still < 350_000
    assert save_html(recording, tmp_path / "recording.html").stat().st_size < still + 60_000
