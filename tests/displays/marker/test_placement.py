"""Placement of markers: frames, stamps and quaternions."""

from math import pi

import numpy as np
import pytest
from geometry_msgs.msg import Pose, Quaternion

from tests.displays.bench import Bench, at, marker, ns


def test_marker_in_the_fixed_frame_requires_no_transform() -> None:
    bench = Bench()
    bench.show(marker(frame="map"), marker(number=1, frame="/map"))
    assert bench.marker_names() == ["n/0", "n/1"]


def test_frame_change_places_its_markers_once() -> None:
    bench = Bench()
    bench.transform("map", "base", (1.0, 0.0, 0.0), yaw=pi / 2)
    bench.show(marker(frame="base", pose=at(2.0)))
    np.testing.assert_allclose(bench.place("n/0")[:3, 3], [1, 2, 0], atol=1e-12)
    bench.transform("map", "base", (9.0, 0.0, 0.0), at=1.0)
    bench.update(2.0)
    np.testing.assert_allclose(bench.place("n/0")[:3, 3], [1, 2, 0], atol=1e-12)


def test_marker_left_behind_by_its_frame_causes_a_hint() -> None:
    bench = Bench()
    bench.transform("map", "base")
    bench.show(marker(frame="base"), marker(number=1, frame="base", frame_locked=True))
    bench.transform("map", "base", (1.0, 0.0, 0.0), at=0.5)
    bench.update(0.5)
    assert bench.hints(bench.array) == []
    bench.update(1.5)
    (hint,) = bench.hints(bench.array)
    assert hint.startswith("base has moved since this marker arrived")


def test_locked_marker_follows_its_frame_regardless_of_its_stamp() -> None:
    bench = Bench()
    locked = marker(frame="base", pose=at(2.0), frame_locked=True)
    locked.header.stamp.sec = 10**9
    bench.transform("map", "base", (1.0, 0.0, 0.0))
    bench.show(locked)
    bench.transform("map", "base", (5.0, 0.0, 0.0), yaw=pi / 2, at=1.0)
    bench.update(2.0)
    np.testing.assert_allclose(bench.place("n/0")[:3, 3], [5, 2, 0], atol=1e-12)


def test_locked_marker_is_hidden_while_its_frame_is_unknown() -> None:
    bench = Bench()
    bench.transform("map", "other")
    bench.show(marker(frame="base", frame_locked=True))
    assert bench.marker_names() == []
    assert bench.status(bench.array, "n/0") == ("error", "For frame [base]: Frame [base] does not exist")
    bench.transform("map", "base", (1.0, 0.0, 0.0), at=1.0)
    bench.update(2.0)
    assert bench.marker_names() == ["n/0"]


def test_stamped_marker_uses_the_transform_at_its_stamp() -> None:
    bench = Bench()
    for second in (0.0, 1.0):
        bench.transform("map", "base", (second, 0.0, 0.0), at=second, static=False)
    stamped = marker(frame="base")
    stamped.header.stamp.sec, stamped.header.stamp.nanosec = divmod(ns(0.25), 10**9)
    bench.show(stamped, at=2.0)
    np.testing.assert_allclose(bench.place("n/0")[0, 3], 0.25)


ERRORS = {
    "unknown frame": ("map", "base", "For frame [base]: Frame [base] does not exist"),
    "unknown fixed frame": ("world", "odom", "For frame [odom]: Fixed Frame [world] does not exist"),
    "empty frame": ("map", "", "For frame []: Frame [] does not exist"),
    "two trees": (
        "map",
        "moon",
        "No transform to fixed frame [map]. TF error: [Could not find a connection between 'map' "
        "and 'moon' because they are not part of the same tree.Tf has two or more unconnected "
        "trees.]",
    ),
}


@pytest.mark.parametrize("name", ERRORS)
def test_marker_without_a_transform_is_hidden_and_an_error(name: str) -> None:
    fixed_frame, frame, text = ERRORS[name]
    bench = Bench(fixed_frame)
    bench.transform("map", "odom")
    bench.transform("space", "moon")
    bench.show(marker(frame=frame))
    assert bench.status(bench.array, "n/0") == ("error", text)
    assert bench.marker_names() == []


def test_hidden_marker_is_shown_again_after_a_message_with_a_known_frame() -> None:
    bench = Bench()
    bench.show(marker(pose=at(1.0)))
    bench.show(marker(frame="nowhere"), at=1.0)
    assert bench.marker_names() == []
    bench.show(marker(), at=2.0)
    assert bench.marker_names() == ["n/0"]
    assert bench.status(bench.array, "n/0") is None


QUATERNIONS = [
    (Quaternion(x=0.0, y=0.0, z=0.0, w=0.0), 180.0),
    (Quaternion(z=1.0, w=1.0), 106.26),
    (Quaternion(z=0.5, w=0.5), 67.38),
    (Quaternion(z=0.7, w=0.7), 89.42),
    (Quaternion(z=0.5**0.5, w=0.5**0.5), 90.0),
]


@pytest.mark.parametrize(("quaternion", "degrees"), QUATERNIONS)
def test_non_unit_quaternions_rotate_as_in_rviz2(quaternion: Quaternion, degrees: float) -> None:
    bench = Bench()
    bench.show(marker(pose=Pose(orientation=quaternion)))
    turned = bench.place("n/0")
    assert np.degrees(np.arctan2(turned[1, 0], turned[0, 0])) % 360 == pytest.approx(degrees, abs=0.01)
    np.testing.assert_allclose(turned[:3, :3] @ turned[:3, :3].T, np.eye(3), atol=1e-9)


@pytest.mark.parametrize("locked", [False, True])
def test_zero_quaternion_is_a_half_turn_of_the_fixed_frame(locked: bool) -> None:
    bench = Bench()
    bench.transform("map", "base", (1.0, 0.0, 0.0), yaw=0.7)
    none = Pose(orientation=Quaternion(x=0.0, y=0.0, z=0.0, w=0.0))
    bench.show(marker(frame="base", pose=none, frame_locked=locked))
    np.testing.assert_allclose(bench.place("n/0")[:3, :3], np.diag([-1, -1, 1]), atol=1e-9)
