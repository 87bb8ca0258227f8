"""Transformation of point clouds. Importing the module registers it for buffers."""

from typing import Any

from geometry_msgs.msg import Transform, TransformStamped
from numpy.lib.recfunctions import structured_to_unstructured
from sensor_msgs.msg import PointCloud2
from sensor_msgs_py.point_cloud2 import create_cloud, read_points
from std_msgs.msg import Header
from tf2_ros.buffer_interface import TransformRegistration
from transforms3d.quaternions import quat2mat

from course_lib.arrays import Matrix

_XYZ = ["x", "y", "z"]


def transform_points(point_cloud: Any, transform: Transform) -> Matrix:
    """Transform points, shape (N, 3), to the parent frame of the transform."""
    shift, turn = transform.translation, transform.rotation
    rotation = quat2mat((turn.w, turn.x, turn.y, turn.z))
    transformed: Matrix = point_cloud @ rotation.T + (shift.x, shift.y, shift.z)
    return transformed


def do_transform_cloud(cloud: PointCloud2, transform: Transform | TransformStamped) -> PointCloud2:
    """Transform a cloud to the parent frame of the transform.

    Fields other than x, y and z are unchanged.
    """
    header = Header(stamp=cloud.header.stamp, frame_id=cloud.header.frame_id)
    if isinstance(transform, TransformStamped):
        header.frame_id, transform = transform.header.frame_id, transform.transform
    present = {field.name for field in cloud.fields}
    assert present.issuperset(_XYZ), "Point cloud needs the fields x, y, and z for the transformation"
    points = read_points(cloud).copy()
    transformed = transform_points(structured_to_unstructured(points[_XYZ]), transform)
    for column, name in enumerate(_XYZ):
        points[name] = transformed[:, column]
    return create_cloud(header, cloud.fields, points, cloud.point_step)


TransformRegistration().add(PointCloud2, do_transform_cloud)
