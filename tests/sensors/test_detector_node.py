from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.errors import CourseError
from course_lib.sensors.checked import Floats
from course_lib.sensors.detector import Detector
from course_lib.sensors.detector_node import DetectorNode, quaternion
from course_lib.sensors.motion import circle, placed
from course_lib.sensors.shapes import box
from course_lib.sensors.world import Thing, World
from tests.sensors.scenes import AT_ORIGIN, published

WORLD = World([
    Thing(box(0.5, 0.5, 1.8), placed(10, 0, 0.9, np.pi / 2), label="Person"),
    Thing(box(2, 1, 1), circle((0, 5, 0.5), 1, 10), label="Car"),
])  # fmt: skip


def markers(seconds: float = 0.5, **settings: Any) -> list[Any]:
    arrays = published(lambda: DetectorNode(Detector(WORLD, AT_ORIGIN), **settings), MarkerArray, seconds)
    return [marker for array in arrays for marker in array.markers]


def test_a_detection_is_a_box_a_label_and_for_what_moves_an_arrow() -> None:
    drawn = [(marker.ns, marker.id, marker.type) for marker in markers()]
    assert drawn == [
        ("boxes", 1, Marker.CUBE), ("labels", 1, Marker.TEXT_VIEW_FACING),
        ("boxes", 2, Marker.CUBE), ("labels", 2, Marker.TEXT_VIEW_FACING), ("velocities", 2, Marker.ARROW),
    ]  # fmt: skip


def test_boxes_have_place_size_turn_colour_and_lifetime() -> None:
    marker = markers(frame_id="world", lifetime=1.5)[0]
    assert (marker.pose.position.x, marker.pose.position.z) == (10, 0.9)
    assert marker.pose.orientation.z == pytest.approx(np.sqrt(0.5))
    assert (marker.scale.x, marker.scale.z) == (0.5, 1.8)
    sure = 0.75
    assert (marker.color.r, marker.color.g, marker.color.a) == pytest.approx((1 - sure, sure, 0.5), abs=0.01)
    assert (marker.header.frame_id, marker.lifetime.sec, marker.lifetime.nanosec) == ("world", 1, 500_000_000)


def test_labels_say_what_and_how_sure_half_a_metre_above_the_box() -> None:
    label = markers()[1]
    assert label.text == "Person (0.75)"
    assert label.pose.position.z == pytest.approx(0.9 + 0.9 + 0.5)


def test_arrows_point_to_where_it_will_be_in_a_second() -> None:
    arrow = markers()[-1]
    ends = np.array([(point.x, point.y, point.z) for point in arrow.points])
    expected = WORLD.things[1].velocity_at(0.5)
    np.testing.assert_allclose(ends[1] - ends[0], expected, atol=1e-6)


def test_below_the_threshold_nothing_is_drawn() -> None:
    assert {marker.id for marker in markers(threshold=0.8)} == {2}  # the nearer one


def test_a_threshold_that_is_none_is_named() -> None:
    with pytest.raises(CourseError, match="threshold is 3; give a number >= 0 and <= 1"):
        markers(threshold=3)


def rotation_of(x: float, y: float, z: float, w: float) -> Floats:
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turned: Floats = np.eye(3) + 2 * w * cross + 2 * cross @ cross
    return turned


@given(st.integers(0, 2**32))
def test_quaternions_give_their_rotation_back(seed: int) -> None:
    xyzw = np.random.default_rng(seed).standard_normal(4)
    rotation = rotation_of(*(xyzw / np.linalg.norm(xyzw)))
    np.testing.assert_allclose(rotation_of(*quaternion(rotation)), rotation, atol=1e-9)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_half_turns_have_quaternions_too(axis: int) -> None:
    rotation = 2 * np.outer(np.eye(3)[axis], np.eye(3)[axis]) - np.eye(3)
    assert np.abs(quaternion(rotation)).tolist() == np.eye(4)[axis].tolist()
