"""Conversions of points, vectors, quaternions and transforms."""

from typing import Any

import numpy as np
from geometry_msgs.msg import Point, Pose, Quaternion, Transform, Vector3
from numpy.typing import NDArray
from tf_transformations import quaternion_from_matrix, quaternion_matrix

from ros2_numpy.registry import converts_from_numpy, converts_to_numpy

Floats = NDArray[np.float64]


@converts_to_numpy(Vector3)
def vector3_to_numpy(msg: Vector3, hom: bool = False) -> Floats:
    """Return [x, y, z] or, if `hom` is true, the homogeneous coordinates [x, y, z, 0]."""
    return np.array([msg.x, msg.y, msg.z, 0.0] if hom else [msg.x, msg.y, msg.z])


@converts_from_numpy(Vector3)
def numpy_to_vector3(arr: Any) -> Any:
    """Convert 3 or 4 numbers to a vector, or an array with more axes to nested lists of vectors."""
    return _of_last_axis(Vector3, arr, homogeneous=0.0)


@converts_to_numpy(Point)
def point_to_numpy(msg: Point, hom: bool = False) -> Floats:
    """Return [x, y, z] or, if `hom` is true, the homogeneous coordinates [x, y, z, 1]."""
    return np.array([msg.x, msg.y, msg.z, 1.0] if hom else [msg.x, msg.y, msg.z])


@converts_from_numpy(Point)
def numpy_to_point(arr: Any) -> Any:
    """Convert 3 or 4 numbers to a point, or an array with more axes to a nested list of points."""
    return _of_last_axis(Point, arr, homogeneous=1.0)


@converts_to_numpy(Quaternion)
def quat_to_numpy(msg: Quaternion) -> Floats:
    """Return [x, y, z, w]."""
    return np.array([msg.x, msg.y, msg.z, msg.w])


@converts_from_numpy(Quaternion)
def numpy_to_quat(arr: Any) -> Any:
    """Convert [x, y, z, w] to a quaternion, or an array with more axes to a nested list of quaternions."""
    values = np.asarray(arr, dtype=float)
    if values.shape[-1:] != (4,):
        raise ValueError(f"a quaternion has the four numbers x, y, z, w, not the shape {values.shape}")
    if values.ndim > 1:
        return [numpy_to_quat(one) for one in values]
    x, y, z, w = map(float, values)
    return Quaternion(x=x, y=y, z=z, w=w)


@converts_to_numpy(Transform)
def transform_to_numpy(msg: Transform) -> Floats:
    """Return the transformation matrix, shape (4, 4)."""
    return _matrix(vector3_to_numpy(msg.translation), quat_to_numpy(msg.rotation))


@converts_from_numpy(Transform)
def numpy_to_transform(arr: Any) -> Transform:
    """Convert a transformation matrix of shape (4, 4) to a Transform."""
    matrix = _as_transform(arr)
    return Transform(
        translation=numpy_to_vector3(matrix[:3, 3]), rotation=numpy_to_quat(quaternion_from_matrix(matrix))
    )


@converts_to_numpy(Pose)
def pose_to_numpy(msg: Pose) -> Floats:
    """Return the transformation matrix, shape (4, 4)."""
    return _matrix(point_to_numpy(msg.position), quat_to_numpy(msg.orientation))


@converts_from_numpy(Pose)
def numpy_to_pose(arr: Any) -> Pose:
    """Convert a transformation matrix of shape (4, 4) to a Pose."""
    matrix = _as_transform(arr)
    return Pose(
        position=numpy_to_point(matrix[:3, 3]), orientation=numpy_to_quat(quaternion_from_matrix(matrix))
    )


def _of_last_axis(cls: type[Any], arr: Any, homogeneous: float) -> Any:
    values = np.asarray(arr, dtype=float)
    if values.ndim > 1:
        return [_of_last_axis(cls, one, homogeneous) for one in values]
    if values.shape not in ((3,), (4,)):
        raise ValueError(f"a {cls.__name__} has three or four numbers, not the shape {values.shape}")
    if len(values) == 4:
        if homogeneous and values[3] == 0:
            raise ValueError("the fourth number of a point must not be 0")
        if not homogeneous and values[3] != 0:
            raise ValueError("the fourth number of a vector must be 0")
        values = values[:3] / values[3] if homogeneous else values[:3]
    x, y, z = map(float, values)
    return cls(x=x, y=y, z=z)


def _matrix(translation: Floats, quaternion: Floats) -> Floats:
    matrix = np.array(quaternion_matrix(quaternion))
    matrix[:3, 3] = translation
    return matrix


def _as_transform(arr: Any) -> Floats:
    matrix = np.asarray(arr, dtype=float)
    if matrix.shape != (4, 4):
        raise ValueError(f"a transform is a (4, 4) matrix, not of the shape {matrix.shape}")
    return matrix
