import tracemalloc
from typing import Any

import numpy as np
import pytest

from course_lib.viewer import scene_recording
from course_lib.viewer.drawables import Inset, Points, Solids, Text
from course_lib.viewer.scene import Scene
from course_lib.viewer.scene_recording import FrameStore, SceneRecording
from tests.viewer.test_stream import RED_BOX, decoded, moved

PICTURE = np.zeros((120, 160, 3), np.uint8)


def filled(frames: int, store: FrameStore | None = None) -> FrameStore:
    made = store or FrameStore()
    for number in range(frames):
        picture = PICTURE.copy()
        picture[:, number % 160] = 255
        made.begin(float(number))
        made.add("object", "camera", Inset(picture))
        made.add("transform", "camera", moved(float(number)))
        made.add("visible", "camera", number % 2 == 0)
    return made


def values(made: FrameStore) -> list[Any]:
    return [
        (
            f.time,
            list(f.changes),
            *(v.pixels.sum() if isinstance(v, Inset) else v for v in f.changes.values()),
        )
        for f in made.frames()
    ]


def test_packed_frames_are_restored_unchanged(monkeypatch: pytest.MonkeyPatch) -> None:
    made = values(filled(300))
    monkeypatch.setattr(scene_recording, "_LARGE", -1)  # nothing is packed
    np.testing.assert_equal(made, values(filled(300)))
    assert len(made) == 300


def test_packed_frames_have_a_tenth_of_their_bytes() -> None:
    tracemalloc.start()
    made = filled(1000)
    size = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert size < 1000 * PICTURE.nbytes / 10
    assert made.size < 1000 * PICTURE.nbytes / 10


def test_large_values_are_not_packed() -> None:
    store, cloud = FrameStore(), Points(np.zeros((100_000, 3)), (1, 0, 0, 1), (0.1, 0.1))
    for number in range(20):
        store.begin(float(number))
        store.add("object", "cloud", cloud)
    assert all(frame.changes["object", "cloud"] is cloud for frame in store.frames())


def test_value_of_a_redefined_class_does_not_stop_the_recording() -> None:
    class Sign(Text):
        pass

    store, sign = FrameStore(), Sign("a", 1.0)
    for number in range(200):
        store.begin(float(number))
        store.add("object", "sign", sign)
    assert [frame.changes["object", "sign"] for frame in store.frames()] == [sign] * 200


def test_oldest_frames_are_dropped_first_and_free_their_bytes() -> None:
    made = filled(200)
    times = [made.drop_oldest().time for _ in range(199)]
    assert times == list(range(199))
    assert (len(made), made.start) == (1, 199.0)
    made.drop_oldest()
    assert (len(made), made.newest) == (0, None)
    assert made.size == pytest.approx(0.0, abs=1e-3)


def test_frames_can_be_dropped_while_others_read_them() -> None:
    made = filled(200)
    reading = made.frames()
    first = next(reading)
    for _ in range(150):
        made.drop_oldest()
    assert [first.time, *(frame.time for frame in reading)] == list(range(200))


def test_packed_recording_plays_the_same_as_an_unpacked_recording(monkeypatch: pytest.MonkeyPatch) -> None:
    def played() -> Any:
        now, scene = [0.0], Scene()
        scene.set_object("a", RED_BOX)
        recording = SceneRecording(scene, lambda: now[0])
        for number in range(200):
            now[0] += 0.1
            scene.set_transform("a", moved(float(number)))
            scene.set_object(f"b{number % 7}", Solids("box", [moved(float(number))], (1, 0, 0, 1)))
        return recording.pack(), recording.pack(3.0)

    packed = played()
    monkeypatch.setattr(scene_recording, "_LARGE", -1)
    assert packed == played()
    assert len(decoded(packed[0])["batches"]) == 201
