from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import (
    Point32,
    PointStamped,
    PolygonStamped,
    Pose,
    PoseStamped,
    PoseWithCovarianceStamped,
    TransformStamped,
    Vector3Stamped,
)
from hypothesis import given
from hypothesis import strategies as st
from tf2_geometry_msgs import (
    do_transform_point,
    do_transform_polygon_stamped,
    do_transform_pose,
    do_transform_pose_stamped,
    do_transform_pose_with_covariance_stamped,
    do_transform_vector3,
    transform_covariance,
)
from transforms3d.affines import compose
from transforms3d.quaternions import mat2quat, quat2mat

Numbers = tuple[float, ...]
numbers = st.floats(-5.0, 5.0)
places = st.tuples(numbers, numbers, numbers)
turns = st.tuples(numbers, numbers, numbers, numbers).filter(lambda q: np.linalg.norm(q) > 0.1)  # any length


def placed(where: Any, xyz: Numbers) -> None:
    where.x, where.y, where.z = xyz


def turned(what: Any, xyzw: Numbers) -> None:
    what.x, what.y, what.z, what.w = xyzw


def transform(shift: Numbers, turn: Numbers) -> TransformStamped:
    message = TransformStamped(child_frame_id="camera")
    message.header.frame_id = "map"
    placed(message.transform.translation, shift)
    turned(message.transform.rotation, turn)
    return message


def matrix(shift: Numbers, turn: Numbers) -> Any:
    """By transforms3d, as in the ROS package; shape (4, 4)."""
    return compose(shift, quat2mat(np.roll(turn, 1)), np.ones(3))


@pytest.mark.slow
@given(places, turns, places)
def test_points_vectors_and_polygons_agree_with_matrix_products(
    shift: Numbers, turn: Numbers, place: Numbers
) -> None:
    point, polygon, vector = PointStamped(), PolygonStamped(), Vector3Stamped()
    placed(point.point, place)
    placed(vector.vector, place)
    polygon.polygon.points.append(Point32(x=place[0], y=place[1], z=place[2]))
    expected = (matrix(shift, turn) @ [*place, 1.0])[:3]
    transformed = do_transform_point(point, transform(shift, turn))
    np.testing.assert_allclose(
        [transformed.point.x, transformed.point.y, transformed.point.z], expected, atol=1e-9
    )
    (corner,) = do_transform_polygon_stamped(polygon, transform(shift, turn)).polygon.points
    np.testing.assert_allclose([corner.x, corner.y, corner.z], expected, atol=1e-5)
    arrow = do_transform_vector3(vector, transform(shift, turn)).vector
    np.testing.assert_allclose([arrow.x, arrow.y, arrow.z], matrix(shift, turn)[:3, :3] @ place, atol=1e-9)


@pytest.mark.slow
@given(places, turns, places, turns)
def test_poses_are_composed_and_their_quaternions_have_a_positive_w(
    shift: Numbers,
    turn: Numbers,
    place: Numbers,
    orientation: Numbers,
) -> None:
    pose = Pose()
    placed(pose.position, place)
    turned(pose.orientation, orientation)
    transformed = do_transform_pose(pose, transform(shift, turn))
    expected = matrix(shift, turn) @ matrix(place, orientation)
    p, q = transformed.position, transformed.orientation
    np.testing.assert_allclose([p.x, p.y, p.z], expected[:3, 3], atol=1e-9)
    np.testing.assert_allclose(quat2mat([q.w, q.x, q.y, q.z]), expected[:3, :3], atol=1e-9)
    assert q.w >= 0
    if q.w > 1e-6:
        np.testing.assert_allclose([q.w, q.x, q.y, q.z], mat2quat(expected[:3, :3]), atol=1e-7)


@pytest.mark.slow
@given(turns)
def test_covariance_is_rotated_with_its_pose(turn: Numbers) -> None:
    half = np.random.default_rng(1).normal(size=(6, 6))
    covariance = half @ half.T
    found = transform_covariance(covariance.reshape(36), transform((1.0, 2.0, 3.0), _unit(turn))).reshape(
        6, 6
    )
    rotation = quat2mat(np.roll(turn, 1))
    for rows in (slice(0, 3), slice(3, 6)):
        for columns in (slice(0, 3), slice(3, 6)):
            block = rotation @ covariance[rows, columns] @ rotation.T
            np.testing.assert_allclose(found[rows, columns], block, atol=1e-9)


def _unit(turn: Numbers) -> Numbers:
    return tuple(np.array(turn) / np.linalg.norm(turn))


def test_results_have_the_header_of_the_transform() -> None:
    moving = transform((1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))
    assert do_transform_pose_stamped(PoseStamped(), moving).header is moving.header
    with_covariance = do_transform_pose_with_covariance_stamped(PoseWithCovarianceStamped(), moving)
    assert with_covariance.header is moving.header
    assert with_covariance.pose.pose.position.x == 1.0


def test_transforming_a_vector_clears_the_translation_of_the_passed_transform_as_in_ros() -> None:
    moving = transform((1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0))
    do_transform_vector3(Vector3Stamped(), moving)
    assert moving.transform.translation.x == 0.0


def test_zero_quaternion_is_treated_as_the_identity_rotation() -> None:
    pose = Pose()
    turned(pose.orientation, (0.0, 0.0, 0.0, 0.0))
    transformed = do_transform_pose(pose, transform((1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)))
    assert (transformed.position.x, transformed.orientation.w) == (1.0, 1.0)


def test_module_can_be_imported_by_its_path_in_ros() -> None:
    from tf2_geometry_msgs.tf2_geometry_msgs import do_transform_point as same

    assert same is do_transform_point


@pytest.mark.parametrize("length", [0.5, 2.0])
def test_quaternion_norm_does_not_scale_the_result(length: float) -> None:
    point = PointStamped()
    point.point.x = 1.0
    transformed = do_transform_point(point, transform((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, length)))
    assert transformed.point.x == pytest.approx(1.0)
