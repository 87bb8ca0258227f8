"""Rigid motions and their twists, shape (6,): along x, y, z [m], then about x, y, z [rad]."""

from math import sin, tan

import numpy as np

from course_lib.arrays import Floats, Matrix

_SMALL = 1e-3  # [rad] below it series are exact to the last bits, and quotients are not

_CROSSED = np.array(
    [[0, 0, 0, 0, 0, -1, 0, 1, 0], [0, 0, 1, 0, 0, 0, -1, 0, 0], [0, -1, 0, 1, 0, 0, 0, 0, 0.0]]
)


def crossed(vector: Floats) -> Matrix:
    """Return the matrices by which vectors, shape (…, 3), multiply as a cross product, shape (…, 3, 3)."""
    matrices: Matrix = (vector @ _CROSSED).reshape(*vector.shape, 3)
    return matrices


def inverse(transform: Matrix) -> Matrix:
    """Return the inverse of a rigid transform, shape (4, 4)."""
    back = np.eye(4)
    back[:3, :3] = transform[:3, :3].T
    back[:3, 3] = -transform[:3, :3].T @ transform[:3, 3]
    return back


def motion_of(twist: Floats) -> Matrix:
    """Return the motion, shape (4, 4), that a twist leads to in one second."""
    about = crossed(twist[3:])
    angle = float(np.linalg.norm(twist[3:]))
    if angle < _SMALL:
        first, second, third = 1 - angle**2 / 6, 0.5 - angle**2 / 24, 1 / 6 - angle**2 / 120
    else:
        first = sin(angle) / angle
        second, third = 2 * sin(angle / 2) ** 2 / angle**2, (1 - first) / angle**2
    motion = np.eye(4)
    motion[:3, :3] += first * about + second * about @ about
    motion[:3, 3] = twist[:3] + second * about @ twist[:3] + third * about @ about @ twist[:3]
    return motion


def twist_of(motion: Matrix) -> Floats:
    """Return the twist that leads to a motion, shape (4, 4), in one second, by half a circle at most."""
    turn = _vector_of(motion[:3, :3])
    angle = float(np.linalg.norm(turn))
    if angle < _SMALL:
        along, across = 1 - angle**2 / 12, 1 / 12 + angle**2 / 720
    else:
        along = angle / 2 / tan(angle / 2)
        across = (1 - along) / angle**2
    way = motion[:3, 3]
    return np.concatenate([along * way - crossed(turn) @ way / 2 + across * (turn @ way) * turn, turn])


def _vector_of(rotation: Matrix) -> Floats:
    """Return the axis of a rotation, shape (3, 3), times its angle [rad]."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation.tolist()
    sine_axis = np.array([zy - yz, xz - zx, yx - xy]) / 2
    sine, cosine = float(np.linalg.norm(sine_axis)), (xx + yy + zz - 1) / 2
    angle = np.arctan2(sine, cosine)
    if cosine > 0:
        turn: Floats = sine_axis * (angle / sine if sine else 1.0)
        return turn
    # Near half a circle the axis is in the symmetric part: (1 - cosine) axis axisᵀ + cosine I.
    square = (rotation + rotation.T) / 2 - cosine * np.eye(3)
    column = square[:, np.argmax(np.diag(square))]
    axis: Floats = column / np.linalg.norm(column) * (angle if column @ sine_axis >= 0 else -angle)
    return axis


def twist_jacobian(twist: Floats) -> Matrix:
    """Return the change of a motion's twist with a small twist before the motion, shape (6, 6).

    It is the inverse of the left Jacobian of SE(3), as a polynomial of the twist's adjoint.
    """
    adjoint = np.zeros((6, 6))
    adjoint[:3, :3] = adjoint[3:, 3:] = crossed(twist[3:])
    adjoint[:3, 3:] = crossed(twist[:3])
    square = adjoint @ adjoint
    second, fourth = _coefficients(float(np.linalg.norm(twist[3:])))
    return np.eye(6) - adjoint / 2 + second * square + fourth * square @ square


def _coefficients(angle: float) -> tuple[float, float]:
    """Return the factors of the adjoint's square and fourth power, by x / 2 cot(x / 2) and its slope."""
    if angle < 0.1:
        return 1 / 12 - angle**4 / 30240, -1 / 720 - angle**2 / 15120
    half = angle / 2
    value = half / tan(half)
    slope = (1 / tan(half) - half / sin(half) ** 2) / (8 * half)  # by the angle's square
    fourth = float(1 + angle**2 * slope - value) / angle**4
    return 2 * angle**2 * fourth - float(slope), fourth
