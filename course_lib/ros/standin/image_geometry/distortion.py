"""OpenCV's lens model: k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4, tau_x, tau_y."""

import math
from collections.abc import Sequence

import numpy as np

from course_lib.arrays import Matrix

_COUNTS = (4, 5, 8, 12, 14)  # coefficients that OpenCV accepts
_STEPS = 5  # of OpenCV's iteration


def undistorted(x: float, y: float, coefficients: Sequence[float]) -> tuple[float, float]:
    """Return the place of a point in an image without distortion, at a focal length of 1.

    Raises:
        ValueError: A number of coefficients that the model does not have.
    """
    if len(coefficients) not in _COUNTS:
        raise ValueError(
            f"The camera's d has {len(coefficients)} coefficients; the model has {_COUNTS} or none. "
            "Look at the publisher of the CameraInfo."
        )
    *lens, tau_x, tau_y = (*coefficients, *[0.0] * (14 - len(coefficients)))
    straight_x, straight_y = x, y
    if tau_x or tau_y:
        straight_x, straight_y, scale = np.linalg.solve(_tilt(tau_x, tau_y), [x, y, 1.0]).tolist()
        straight_x, straight_y = straight_x / scale, straight_y / scale
    return _without_lens(straight_x, straight_y, lens) or (x, y)


def _without_lens(x: float, y: float, lens: Sequence[float]) -> tuple[float, float] | None:
    """Return the place of a point without the lens; None where the model has none."""
    k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4 = lens
    x0, y0 = x, y
    for _ in range(_STEPS):
        r2 = x * x + y * y
        scale = (1 + ((k6 * r2 + k5) * r2 + k4) * r2) / (1 + ((k3 * r2 + k2) * r2 + k1) * r2)
        if scale < 0:
            return None
        shift_x = 2 * p1 * x * y + p2 * (r2 + 2 * x * x) + s1 * r2 + s2 * r2 * r2
        shift_y = p1 * (r2 + 2 * y * y) + 2 * p2 * x * y + s3 * r2 + s4 * r2 * r2
        x, y = (x0 - shift_x) * scale, (y0 - shift_y) * scale
    return x, y


def _tilt(tau_x: float, tau_y: float) -> Matrix:
    """Return the projection onto a sensor that is turned by two angles, [rad]."""
    sin_x, cos_x, sin_y, cos_y = math.sin(tau_x), math.cos(tau_x), math.sin(tau_y), math.cos(tau_y)
    about_x = np.array([[1, 0, 0], [0, cos_x, sin_x], [0, -sin_x, cos_x]])
    about_y = np.array([[cos_y, 0, -sin_y], [0, 1, 0], [sin_y, 0, cos_y]])
    turned = about_y @ about_x
    onto = np.array([[turned[2, 2], 0, -turned[0, 2]], [0, turned[2, 2], -turned[1, 2]], [0, 0, 1]])
    projection: Matrix = onto @ turned
    return projection
