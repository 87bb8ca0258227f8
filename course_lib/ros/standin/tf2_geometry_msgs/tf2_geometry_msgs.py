"""Transformations of the stamped types of geometry_msgs.

Importing the module registers them for buffers.
"""

from typing import Any

import numpy as np
from geometry_msgs.msg import (
    Point,
    Point32,
    PointStamped,
    Polygon,
    PolygonStamped,
    Pose,
    PoseStamped,
    PoseWithCovarianceStamped,
    Quaternion,
    TransformStamped,
    Vector3Stamped,
)
from tf2_ros.buffer_interface import TransformRegistration

from course_lib.arrays import Floats
from course_lib.ros.tf2 import IDENTITY, Transform, compose, to_unit_quaternion
from course_lib.ros.tf2 import Pose as Placement


def do_transform_point(point: PointStamped, transform: TransformStamped) -> PointStamped:
    """Transform a point to the parent frame of the transform."""
    x, y, z = _transform_placement(transform, point.point)[0]
    return PointStamped(header=transform.header, point=Point(x=x, y=y, z=z))


def do_transform_vector3(vector3: Vector3Stamped, transform: TransformStamped) -> Vector3Stamped:
    """Rotate a vector to the parent frame of the transform.

    As in ROS 2, the translation of the passed transform is set to zero.
    """
    shift = transform.transform.translation
    shift.x = shift.y = shift.z = 0.0
    result = Vector3Stamped(header=transform.header)
    result.vector.x, result.vector.y, result.vector.z = _transform_placement(transform, vector3.vector)[0]
    return result


def do_transform_pose(pose: Pose, transform: TransformStamped) -> Pose:
    """Transform a pose without a header to the transform's parent frame.

    Its quaternion has w >= 0.
    """
    (x, y, z), rotation = _transform_placement(transform, pose.position, pose.orientation)
    qx, qy, qz, qw = rotation if rotation[3] >= 0 else (-part for part in rotation)
    return Pose(position=Point(x=x, y=y, z=z), orientation=Quaternion(x=qx, y=qy, z=qz, w=qw))


def do_transform_pose_stamped(pose: PoseStamped, transform: TransformStamped) -> PoseStamped:
    """Transform a pose to the parent frame of the transform."""
    return PoseStamped(header=transform.header, pose=do_transform_pose(pose.pose, transform))


def do_transform_pose_with_covariance_stamped(
    pose: PoseWithCovarianceStamped, transform: TransformStamped
) -> PoseWithCovarianceStamped:
    """Transform a pose with its covariance to the parent frame of the transform."""
    result = PoseWithCovarianceStamped(header=transform.header)
    result.pose.pose = do_transform_pose(pose.pose.pose, transform)
    result.pose.covariance = transform_covariance(pose.pose.covariance, transform)
    return result


def do_transform_polygon_stamped(
    polygon: PolygonStamped,
    transform: TransformStamped,
) -> PolygonStamped:
    """Transform a polygon to the parent frame of the transform."""
    places = [_transform_placement(transform, point)[0] for point in polygon.polygon.points]
    points = [Point32(x=x, y=y, z=z) for x, y, z in places]
    return PolygonStamped(header=transform.header, polygon=Polygon(points=points))


def transform_covariance(cov_in: Floats, transform: TransformStamped) -> Floats:
    """Transform a covariance of (x, y, z, rotation about x, y, z), shape (36,), to the parent frame."""
    turn = Transform.from_message(transform).matrix()[:3, :3]
    block_rotation = np.kron(np.eye(2), turn)
    covariance: Floats = block_rotation @ np.reshape(cov_in, (6, 6)) @ block_rotation.T
    return covariance.reshape(36)


def _transform_placement(
    transform: TransformStamped, place: Any, turn: Quaternion | None = None
) -> Placement:
    """Apply a transform to a position and an orientation.

    Quaternions are normalized. The zero quaternion counts as no rotation.
    """
    shift, outer = Transform.from_message(transform).pose
    inner = IDENTITY[1] if turn is None else to_unit_quaternion((turn.x, turn.y, turn.z, turn.w))
    return compose((shift, to_unit_quaternion(outer)), ((place.x, place.y, place.z), inner))


_registration = TransformRegistration()
_registration.add(PointStamped, do_transform_point)
_registration.add(Vector3Stamped, do_transform_vector3)
_registration.add(PoseStamped, do_transform_pose_stamped)
_registration.add(PoseWithCovarianceStamped, do_transform_pose_with_covariance_stamped)
_registration.add(PolygonStamped, do_transform_polygon_stamped)
