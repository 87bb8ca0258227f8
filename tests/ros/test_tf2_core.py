from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_lib.arrays import Vector
from course_lib.ros.tf2 import (
    BufferCore,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    Quaternion,
    Transform,
)

S = 1_000_000_000  # [ns]
NONE: Quaternion = (0.0, 0.0, 0.0, 1.0)


def turn(angle: float) -> Quaternion:
    """Turn about z."""
    return (0.0, 0.0, float(np.sin(angle / 2)), float(np.cos(angle / 2)))


def step(
    parent: str, child: str, stamp_ns: int = 0, at: Vector = (0.0, 0.0, 0.0), rotation: Quaternion = NONE
) -> Transform:
    return Transform(parent, child, stamp_ns, at, rotation)


def chain() -> BufferCore:
    buffer = BufferCore()
    buffer.set_transform(step("map", "odom", at=(1.0, 0.0, 0.0), rotation=turn(pi / 2)), is_static=True)
    buffer.set_transform(step("odom", "base", at=(2.0, 0.0, 0.5)), is_static=True)
    buffer.set_transform(step("map", "beacon", at=(0.0, 0.0, 3.0)), is_static=True)
    return buffer


def test_transforms_are_composed_up_the_tree() -> None:
    transform = chain().lookup("map", "base")
    assert transform.translation == pytest.approx((1.0, 2.0, 0.5))
    assert transform.rotation == pytest.approx(turn(pi / 2))
    assert (transform.parent, transform.child, transform.stamp_ns) == ("map", "base", 0)


def test_transform_down_the_tree_is_the_inverse_of_the_transform_up() -> None:
    buffer = chain()
    up, down = buffer.lookup("map", "base").matrix(), buffer.lookup("base", "map").matrix()
    np.testing.assert_allclose(up @ down, np.eye(4), atol=1e-12)


def test_branches_are_joined_at_their_common_parent() -> None:
    transform = chain().lookup("beacon", "base")
    assert transform.translation == pytest.approx((1.0, 2.0, -2.5))


def test_position_and_rotation_are_interpolated_between_stamps() -> None:
    buffer = BufferCore()
    buffer.set_transform(step("map", "base", 1 * S, (0.0, 0.0, 0.0), turn(0.0)))
    buffer.set_transform(step("map", "base", 2 * S, (4.0, 0.0, 0.0), turn(1.0)))
    transform = buffer.lookup("map", "base", 1 * S + S // 4)
    assert transform.translation == pytest.approx((1.0, 0.0, 0.0))
    assert transform.rotation == pytest.approx(turn(0.25))


def test_rotation_takes_the_shorter_arc_regardless_of_the_quaternion_sign() -> None:
    buffer = BufferCore()
    x, y, z, w = turn(1.0)
    buffer.set_transform(step("map", "base", 1 * S, rotation=turn(0.0)))
    buffer.set_transform(step("map", "base", 2 * S, rotation=(-x, -y, -z, -w)))
    assert buffer.lookup("map", "base", 3 * S // 2).rotation == pytest.approx(turn(0.5))


def test_time_zero_is_the_latest_common_time_of_the_chain() -> None:
    buffer = BufferCore()
    for stamp in (1, 2, 3):
        buffer.set_transform(step("map", "odom", stamp * S, (float(stamp), 0.0, 0.0)))
    for stamp in (1, 2):
        buffer.set_transform(step("odom", "base", stamp * S))
    transform = buffer.lookup("map", "base")
    assert (transform.stamp_ns, transform.translation[0]) == (2 * S, 2.0)


def test_static_transforms_do_not_limit_the_latest_common_time() -> None:
    buffer = chain()
    buffer.set_transform(step("base", "wheel", 5 * S))
    assert buffer.lookup("beacon", "wheel").stamp_ns == 5 * S


def test_transform_of_a_frame_to_itself_is_the_identity_even_for_an_unknown_frame() -> None:
    buffer = BufferCore()
    assert buffer.lookup("nowhere", "nowhere", 7 * S).stamp_ns == 7 * S
    assert buffer.can_transform("nowhere", "nowhere") is None


def test_leading_slashes_are_stripped_from_transforms_and_rejected_in_lookups() -> None:
    buffer = BufferCore()
    buffer.set_transform(step("/map", "/base", 1 * S))
    assert buffer.frames() == ["base", "map"]
    with pytest.raises(InvalidArgumentException) as caught:
        buffer.lookup("/map", "base")
    assert str(caught.value) == (
        'Invalid argument "/map" passed to lookupTransform argument target_frame - '
        "in tf2 frame_ids cannot start with a '/'"
    )
    with pytest.raises(InvalidArgumentException, match="source_frame - in tf2 frame_ids cannot be empty"):
        buffer.lookup("map", "")


@pytest.mark.parametrize(("target", "source"), [("foo", "map"), ("map", "foo")])
def test_unknown_frame_is_reported(target: str, source: str) -> None:
    argument = "target_frame" if target == "foo" else "source_frame"
    with pytest.raises(LookupException) as caught:
        chain().lookup(target, source)
    assert str(caught.value) == f'"foo" passed to lookupTransform argument {argument} does not exist. '
    assert chain().can_transform(target, source) == (
        f'Invalid frame ID "foo" passed to canTransform argument {argument} - frame does not exist'
    )


@pytest.mark.parametrize("time_ns", [0, 1 * S])
def test_lookup_between_disconnected_trees_is_a_connectivity_error(time_ns: int) -> None:
    buffer = chain()
    buffer.set_transform(step("world", "camera"), is_static=True)
    with pytest.raises(ConnectivityException) as caught:
        buffer.lookup("map", "camera", time_ns)
    assert str(caught.value) == (
        "Could not find a connection between 'map' and 'camera' because they are not part of the "
        "same tree.Tf has two or more unconnected trees."
    )


EXTRAPOLATIONS = {
    "future": (
        2 * S,
        "Lookup would require extrapolation into the future.  Requested time 2.000000 but the "
        "latest data is at time 1.500000",
    ),
    "past": (
        S // 2,
        "Lookup would require extrapolation into the past.  Requested time 0.500000 but the "
        "earliest data is at time 1.000000",
    ),
}


@pytest.mark.parametrize("direction", EXTRAPOLATIONS)
@pytest.mark.parametrize(("target", "source"), [("map", "base"), ("base", "map")])
def test_lookup_outside_the_buffered_interval_is_an_extrapolation_error(
    direction: str, target: str, source: str
) -> None:
    time_ns, text = EXTRAPOLATIONS[direction]
    buffer = BufferCore()
    buffer.set_transform(step("map", "base", 1 * S))
    buffer.set_transform(step("map", "base", 3 * S // 2))
    with pytest.raises(ExtrapolationException) as caught:
        buffer.lookup(target, source, time_ns)
    suffix = f", when looking up transform from frame [{source}] to frame [{target}]"
    assert str(caught.value) == text + suffix


def test_single_transform_is_valid_at_its_own_stamp_only() -> None:
    buffer = BufferCore()
    buffer.set_transform(step("map", "base", 1 * S))
    assert buffer.lookup("map", "base", 1 * S).stamp_ns == 1 * S
    with pytest.raises(ExtrapolationException) as caught:
        buffer.lookup("map", "base", 2 * S)
    assert str(caught.value).startswith(
        "Lookup would require extrapolation at time 2.000000, but only time 1.000000 is in the buffer, when"
    )


def test_transforms_are_kept_for_ten_seconds() -> None:
    buffer = BufferCore()
    for stamp in range(1, 22):
        assert buffer.set_transform(step("map", "base", stamp * S)) == ()
    assert buffer.can_transform("map", "base", 11 * S) is None
    assert "the earliest data is at time 10.000000" in str(buffer.can_transform("map", "base", 5 * S))
    (complaint,) = buffer.set_transform(step("map", "base", 5 * S))
    assert complaint.startswith(
        "TF_OLD_DATA ignoring data from the past for frame base at time 5.000000 according to authority "
        "default_authority\nPossible reasons are listed at http://wiki.ros.org/tf/Errors%20explained"
    )


NAN = float("nan")
REJECTED = {
    "TF_SELF_TRANSFORM": step("map", "/map"),
    "TF_NO_CHILD_FRAME_ID": step("map", ""),
    "TF_NO_FRAME_ID": step("", "base"),
    "TF_NAN_INPUT": step("map", "base", at=(NAN, 0.0, 0.0)),
}


@pytest.mark.parametrize("name", REJECTED)
def test_invalid_transform_is_ignored_with_the_violated_rule(name: str) -> None:
    buffer = BufferCore()
    complaints = buffer.set_transform(REJECTED[name])
    assert [complaint.partition(":")[0] for complaint in complaints] == [name]
    assert buffer.frames() == []


@pytest.mark.parametrize(("value", "text"), [(0.0, "-nan"), (NAN, "nan")])
def test_quaternion_without_a_direction_is_rejected(value: float, text: str) -> None:
    nan_input, denormalized = BufferCore().set_transform(step("map", "base", rotation=(value,) * 4))
    child = 'Ignoring transform for child_frame_id "base" from authority "default_authority" because of'
    values = f"({text} {text} {text} {text})"
    assert nan_input == (
        f"TF_NAN_INPUT: {child} a nan value in the transform (0.000000 0.000000 0.000000) {values}"
    )
    assert denormalized == (
        f"TF_DENORMALIZED_QUATERNION: {child} an invalid quaternion in the transform {values}"
    )


@pytest.mark.parametrize("rotation", [(0.0, 0.0, 1.0, 1.0), (0.0, 0.0, -3.0, -3.0), (0.0, 0.0, 1e-3, 1e-3)])
def test_quaternion_of_another_length_is_normalized(rotation: Quaternion) -> None:
    buffer = BufferCore()
    assert buffer.set_transform(step("map", "base", rotation=rotation)) == ()
    assert buffer.lookup("map", "base").rotation == pytest.approx((0.0, 0.0, 0.5**0.5, 0.5**0.5))


def test_loop_in_the_tree_is_an_error() -> None:
    buffer = BufferCore()
    for parent, child in (("a", "b"), ("b", "c"), ("c", "a"), ("x", "y")):
        buffer.set_transform(step(parent, child, 1 * S))
    with pytest.raises(LookupException, match=r"contains a loop\.\nFrame b exists with parent a\."):
        buffer.lookup("x", "a", 1 * S)
    with pytest.raises(LookupException, match="contains a loop"):
        buffer.lookup("x", "a")


def test_static_and_dynamic_transforms_replace_each_other() -> None:
    buffer = BufferCore()
    buffer.set_transform(step("map", "base", 1 * S, (1.0, 0.0, 0.0)))
    buffer.set_transform(step("map", "base", 0, (2.0, 0.0, 0.0)), is_static=True)
    assert buffer.lookup("map", "base", 9 * S).translation[0] == 2.0
    buffer.set_transform(step("map", "base", 3 * S, (3.0, 0.0, 0.0)))
    assert buffer.lookup("map", "base", 3 * S).translation[0] == 3.0


def test_later_of_two_transforms_with_equal_stamps_is_the_latest() -> None:
    buffer = BufferCore()
    for x in (1.0, 2.0, 2.0):
        buffer.set_transform(step("map", "base", 1 * S, (x, 0.0, 0.0)))
    assert buffer.lookup("map", "base").translation[0] == 2.0


def test_clear_keeps_static_transforms_and_frame_names() -> None:
    buffer = chain()
    buffer.set_transform(step("base", "wheel", 1 * S))
    buffer.clear()
    assert buffer.can_transform("map", "base") is None
    assert "wheel" in buffer.frames()
    with pytest.raises(ConnectivityException):
        buffer.lookup("map", "wheel")


angles = st.floats(-pi, pi)
places = st.tuples(*[st.floats(-5.0, 5.0)] * 3)


@given(angles, places, angles, places)
def test_lookups_satisfy_the_group_laws_of_transforms(a: float, p: Vector, b: float, q: Vector) -> None:
    buffer = BufferCore()
    buffer.set_transform(step("map", "left", at=p, rotation=turn(a)), is_static=True)
    buffer.set_transform(step("map", "right", at=q, rotation=turn(b)), is_static=True)
    across = buffer.lookup("left", "right").matrix()
    via_map = buffer.lookup("left", "map").matrix() @ buffer.lookup("map", "right").matrix()
    np.testing.assert_allclose(across, via_map, atol=1e-9)
    np.testing.assert_allclose(across @ buffer.lookup("right", "left").matrix(), np.eye(4), atol=1e-9)
