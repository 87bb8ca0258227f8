from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from vision_msgs.msg import Detection3DArray

from course_lib.arrays import Floats
from course_lib.errors import CourseError
from course_lib.sensors.detector import Detector, DetectorNode, quaternion
from course_lib.sensors.world import Thing, World, box, circle, placed
from tests.sensors.scenes import AT_ORIGIN, published

WORLD = World([
    Thing(box(0.5, 0.5, 1.8), placed(10, 0, 0.9, np.pi / 2), label="Person"),
    Thing(box(2, 1, 1), circle((0, 5, 0.5), 1, 10), label="Car"),
])  # fmt: skip


def detections(seconds: float = 0.5, **settings: Any) -> list[Any]:
    arrays = published(
        lambda: DetectorNode(Detector(WORLD, AT_ORIGIN), **settings), Detection3DArray, seconds
    )
    return [detection for array in arrays for detection in array.detections]


def test_detection_has_its_label_confidence_and_track() -> None:
    messages = [(d.results[0].hypothesis.class_id, d.id) for d in detections()]
    assert messages == [("Person", "1"), ("Car", "2")]
    assert detections()[0].results[0].hypothesis.score == pytest.approx(0.75, abs=0.01)


def test_boxes_have_position_size_and_orientation_in_the_world_frame() -> None:
    detection = detections(frame_id="world")[0]
    assert (detection.bbox.center.position.x, detection.bbox.center.position.z) == (10, 0.9)
    assert detection.bbox.center.orientation.z == pytest.approx(np.sqrt(0.5))
    assert (detection.bbox.size.x, detection.bbox.size.z) == (0.5, 1.8)
    assert detection.header.frame_id == "world"


def test_invalid_rate_is_reported() -> None:
    with pytest.raises(CourseError, match=r"rate \[Hz\] is 0; expected a number > 0"):
        detections(rate=0)


def rotation_of(x: float, y: float, z: float, w: float) -> Floats:
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turned: Floats = np.eye(3) + 2 * w * cross + 2 * cross @ cross
    return turned


@given(st.integers(0, 2**32))
def test_quaternions_convert_back_to_their_rotation(seed: int) -> None:
    xyzw = np.random.default_rng(seed).standard_normal(4)
    rotation = rotation_of(*(xyzw / np.linalg.norm(xyzw)))
    np.testing.assert_allclose(rotation_of(*quaternion(rotation)), rotation, atol=1e-9)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_half_turns_are_converted_to_quaternions(axis: int) -> None:
    rotation = 2 * np.outer(np.eye(3)[axis], np.eye(3)[axis]) - np.eye(3)
    assert np.abs(quaternion(rotation)).tolist() == np.eye(4)[axis].tolist()
