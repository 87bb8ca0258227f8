from typing import Any

import numpy as np
import pytest

from course_lib.viewer.drawables import Solids
from course_lib.viewer.scene import Scene
from course_lib.viewer.scene_recording import SceneRecording
from tests.viewer.test_stream import BLUE_BOX, RED_BOX, decoded, moved


class Clock:
    """Stands until it is set."""

    now = 100.0  # [s]

    def __call__(self) -> float:
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


def packed(recording: SceneRecording) -> Any:
    return decoded(recording.pack())


def test_recording_starts_with_the_whole_scene_and_continues_with_timed_changes(clock: Clock) -> None:
    scene = Scene()
    scene.set_object("a", RED_BOX)
    recording = SceneRecording(scene, clock)
    for x in (1.0, 2.0):
        clock.now += 0.5
        scene.set_transform("a", moved(x))
    clock.now += 1.0
    data = packed(recording)
    assert (data["start"], data["end"], data["note"]) == (100.0, 2.0, "")
    assert [batch["time"] for batch in data["batches"]] == [0.0, 0.5, 1.0]
    assert [c["type"] for c in data["batches"][0]["commands"]] == ["background", "camera", "object"]
    assert [batch["matrices"][9] for batch in data["batches"][1:]] == [1.0, 2.0]
    assert [batch.get("paths") for batch in data["batches"][1:]] == [["a"], None]


def test_simultaneous_changes_form_one_frame_with_the_last_values(clock: Clock) -> None:
    scene = Scene()
    recording = SceneRecording(scene, clock)
    clock.now += 1.0
    scene.set_object("a", RED_BOX)
    scene.delete("a")
    scene.set_object("b", RED_BOX)
    scene.set_object("b", BLUE_BOX)
    _, frame = packed(recording)["batches"]
    assert [(c["type"], c["path"]) for c in frame["commands"]] == [("delete", "a"), ("object", "b")]
    assert frame["commands"][1]["object"]["colors"].tolist() == [0, 0, 255, 255]


def test_recorded_values_are_captured_at_their_time(clock: Clock) -> None:
    scene = Scene()
    recording = SceneRecording(scene, clock)
    for color in ((255, 0, 0), (0, 255, 0)):
        clock.now += 1.0
        scene.background = color
    colors = [c["color"] for b in packed(recording)["batches"][1:] for c in b["commands"]]
    assert colors == [[255, 0, 0], [0, 255, 0]]


def test_recording_without_changes_is_the_scene(clock: Clock) -> None:
    scene = Scene()
    recording = SceneRecording(scene, clock)
    assert "batches" not in packed(recording)


@pytest.mark.parametrize("limits", [{"seconds": 3.0}, {"megabytes": 0.003}])
def test_changes_older_than_the_limit_are_merged_into_the_first_frame(
    clock: Clock, limits: dict[str, float]
) -> None:
    scene = Scene()
    recording = SceneRecording(scene, clock, **limits)
    for number in range(12):
        clock.now += 1.0
        scene.set_object(f"box{number}", RED_BOX)
    data = packed(recording)
    first = [c["path"] for c in data["batches"][0]["commands"] if c["type"] == "object"]
    later = [c["path"] for batch in data["batches"][1:] for c in batch["commands"]]
    assert len(later) < 6
    assert first + later == [f"box{number}" for number in range(12)]
    assert recording.is_truncated
    assert data["note"].startswith(f"Only the last {recording.duration:.0f} s are included")


def test_large_arrays_count_toward_the_limit(clock: Clock) -> None:
    scene = Scene()
    recording = SceneRecording(scene, clock, megabytes=1.0)
    large = Solids("box", np.tile(np.eye(4), (4000, 1, 1)), (1, 0, 0, 1))  # 320 kB
    for number in range(5):
        clock.now += 1.0
        scene.set_object(str(number), large)
    assert recording.is_truncated
    assert len(packed(recording)["batches"]) == 4


def test_recording_restarts_after_a_backward_time_jump(clock: Clock) -> None:
    scene = Scene()
    recording = SceneRecording(scene, clock)
    clock.now += 5.0
    scene.set_object("a", RED_BOX)
    clock.now = 50.0
    scene.set_object("b", RED_BOX)
    clock.now += 1.0
    data = packed(recording)
    assert (data["start"], data["end"]) == (50.0, 1.0)
    assert [c.get("path") for c in data["batches"][0]["commands"]][-1] == "a"


def test_stopped_recording_records_no_further_changes(clock: Clock) -> None:
    scene = Scene()
    recording = SceneRecording(scene, clock)
    recording.stop()
    clock.now += 1.0
    scene.set_object("a", RED_BOX)
    assert "batches" not in packed(recording)


def test_recording_of_the_last_seconds_begins_with_the_scene_at_its_start(clock: Clock) -> None:
    scene = Scene()
    scene.set_object("a", RED_BOX)
    recording = SceneRecording(scene, clock)
    for x in (1.0, 2.0, 3.0):
        clock.now += 1.0
        scene.set_transform("a", moved(x))
    data = decoded(recording.pack(1.5))
    assert (data["start"], data["end"]) == (101.5, 1.5)
    assert [batch["time"] for batch in data["batches"]] == [0.0, 0.5, 1.5]
    assert [batch["matrices"][9] for batch in data["batches"]] == [1.0, 2.0, 3.0]
    clock.now += 5.0
    assert "batches" not in decoded(recording.pack(1.5))


def test_recording_can_be_limited_to_an_end_time_and_fewer_frames(clock: Clock) -> None:
    scene = Scene()
    scene.set_object("a", RED_BOX)
    recording = SceneRecording(scene, clock)
    for x in range(1, 9):
        clock.now += 0.25
        scene.set_transform("a", moved(float(x)))
    data = decoded(recording.pack(until=101.5, interval=0.5))
    assert data["end"] == 1.5
    assert [batch["time"] for batch in data["batches"]] == [0.0, 0.25, 0.75, 1.25]
    assert [batch["matrices"][9] for batch in data["batches"][1:]] == [2.0, 4.0, 6.0]
    (at_first,) = decoded(recording.pack(until=100.0))["commands"][-1:]
    assert at_first["path"] == "a"


def test_recorded_objects_are_hidden_and_shown_at_their_times(clock: Clock) -> None:
    scene = Scene()
    scene.set_object("a", RED_BOX)
    recording = SceneRecording(scene, clock)
    for is_visible in (False, True):
        clock.now += 1.0
        scene.set_visible("a", is_visible)
    commands = [c for batch in packed(recording)["batches"] for c in batch["commands"]]
    assert [c["value"] for c in commands if c["type"] == "visible"] == [False, True]
