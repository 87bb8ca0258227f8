"""Rotations and transforms as matrices and quaternions, based on transforms3d like the ROS package.

Quaternions are (x, y, z, w), angles in [rad]. `axes` names an Euler sequence: s or r for static or
rotating axes, followed by their order. The default sxyz means roll, pitch, yaw.
"""

from collections.abc import Sequence

import numpy as np
from transforms3d import affines, axangles, euler, quaternions

from course_lib.arrays import Floats
from course_lib.ros.tf2 import slerp

Numbers = Sequence[float] | Floats
_NO_SHIFT, _NO_TURN, _NO_ZOOM = np.zeros(3), np.eye(3), np.ones(3)


def translation_matrix(direction: Numbers) -> Floats:
    """Return the matrix of a translation, shape (4, 4)."""
    return _affine(_NO_TURN, direction)


def translation_from_matrix(matrix: Floats) -> Floats:
    """Return the translation of a transform, shape (3,)."""
    return np.array(matrix, float)[:3, 3]


def rotation_matrix(angle: float, direction: Numbers, point: Numbers | None = None) -> Floats:
    """Return the matrix of a rotation about an axis through a point, shape (4, 4)."""
    return np.asarray(axangles.axangle2aff(direction, angle, point=point))


def euler_matrix(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Floats:
    """Return the rotation matrix of three Euler angles, shape (4, 4)."""
    return _affine(euler.euler2mat(ai, aj, ak, axes=axes))


def euler_from_matrix(matrix: Floats, axes: str = "sxyz") -> tuple[float, float, float]:
    """Return the three Euler angles of a rotation."""
    ai, aj, ak = euler.mat2euler(np.asarray(matrix), axes=axes)
    return ai, aj, ak


def euler_from_quaternion(quaternion: Numbers, axes: str = "sxyz") -> tuple[float, float, float]:
    """Return the three Euler angles of a quaternion (x, y, z, w)."""
    return euler_from_matrix(quaternion_matrix(quaternion), axes)


def quaternion_from_euler(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Floats:
    """Return the quaternion (x, y, z, w) of three Euler angles."""
    return np.roll(euler.euler2quat(ai, aj, ak, axes=axes), -1)


def quaternion_about_axis(angle: float, axis: Numbers) -> Floats:
    """Return the quaternion (x, y, z, w) of a rotation about an axis."""
    return np.roll(quaternions.axangle2quat(axis, angle), -1)


def quaternion_matrix(quaternion: Numbers) -> Floats:
    """Return the rotation matrix of a quaternion (x, y, z, w), shape (4, 4)."""
    return _affine(quaternions.quat2mat(np.roll(quaternion, 1)))


def quaternion_from_matrix(matrix: Floats) -> Floats:
    """Return the quaternion (x, y, z, w) of a transform's rotation."""
    return np.roll(quaternions.mat2quat(affines.decompose(np.asarray(matrix))[1]), -1)


def quaternion_multiply(
    quaternion1: Numbers,
    quaternion0: Numbers,
) -> tuple[float, float, float, float]:
    """Return the quaternion (x, y, z, w) that rotates by `quaternion0` first, then by `quaternion1`."""
    w, x, y, z = quaternions.qmult(np.roll(quaternion1, 1), np.roll(quaternion0, 1))
    return x, y, z, w


def quaternion_conjugate(quaternion: Numbers) -> Floats:
    """Return the conjugate of a quaternion (x, y, z, w)."""
    x, y, z, w = quaternion
    return np.array([-x, -y, -z, w])


def quaternion_inverse(quaternion: Numbers) -> Floats:
    """Return the inverse of a quaternion (x, y, z, w)."""
    return quaternion_conjugate(quaternion) / float(np.dot(quaternion, quaternion))


def quaternion_slerp(quat0: Numbers, quat1: Numbers, fraction: float) -> Floats:
    """Interpolate between two quaternions (x, y, z, w) along the shorter arc."""
    x, y, z, w = unit_vector(quat0)
    bx, by, bz, bw = unit_vector(quat1)
    return np.array(slerp((x, y, z, w), (bx, by, bz, bw), fraction))


def unit_vector(data: Numbers) -> Floats:
    """Return a vector scaled to length 1."""
    return np.asarray(data, float) / vector_norm(data)


def vector_norm(data: Numbers) -> float:
    """Return the length of a vector."""
    return float(np.linalg.norm(data))


def inverse_matrix(matrix: Floats) -> Floats:
    """Return the inverse of a transform, shape (4, 4)."""
    return np.linalg.inv(np.asarray(matrix, float)).astype(np.float64)


def concatenate_matrices(*matrices: Floats) -> Floats:
    """Return the product of transforms, shape (4, 4). The last one is applied first."""
    product = np.eye(4)
    for matrix in matrices:
        product = product @ matrix
    return product


def _affine(turn: Floats, shift: Numbers = _NO_SHIFT) -> Floats:
    return np.asarray(affines.compose(shift, turn, _NO_ZOOM))
