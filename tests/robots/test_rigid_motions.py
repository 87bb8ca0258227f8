from math import pi

import numpy as np
import pytest

from course_lib.arrays import Floats
from course_lib.robots.kinematics import inverse, motion_of, twist_jacobian, twist_of
from tests.robots.by_pinocchio import pin

ANGLES = (0.0, 1e-9, 1e-6, 0.9e-3, 1.1e-3, 0.05, 0.11, 1.0, 2.0, 3.1, pi - 1e-7)  # [rad]


def twists(angle: float) -> list[Floats]:
    """Return twists by a way of about 1 m, and by an angle."""
    found = np.random.default_rng(0).normal(size=(20, 6))
    found[:, 3:] *= angle / np.linalg.norm(found[:, 3:], axis=1, keepdims=True)
    return list(found)


@pytest.mark.parametrize("angle", ANGLES)
def test_motions_and_their_twists_agree_with_pinocchio(angle: float) -> None:
    for twist in twists(angle):
        motion = motion_of(twist)
        np.testing.assert_allclose(motion, pin.exp6(twist).homogeneous, atol=1e-9)
        np.testing.assert_allclose(twist_of(motion), twist, atol=1e-9)
        np.testing.assert_allclose(inverse(motion) @ motion, np.eye(4), atol=1e-12)


@pytest.mark.parametrize("axis", [*np.eye(3), -np.eye(3)[1], (0.6, -0.8, 0.0), (2 / 3, 1 / 3, -2 / 3)])
def test_half_turn_twists_survive_a_round_trip(axis: Floats) -> None:
    motion = motion_of(np.array([1.0, 2.0, 3.0, *(np.array(axis) * pi)]))
    np.testing.assert_allclose(motion_of(twist_of(motion)), motion, atol=1e-12)


@pytest.mark.parametrize("angle", [angle for angle in ANGLES if angle < 3])
def test_jacobian_is_the_derivative_of_the_twist(angle: float) -> None:
    small = 1e-6
    for twist in twists(angle):
        slopes = [
            (twist_of(motion_of(step) @ motion_of(twist)) - twist_of(motion_of(-step) @ motion_of(twist)))
            / (2 * small)
            for step in small * np.eye(6)
        ]
        np.testing.assert_allclose(twist_jacobian(twist), np.array(slopes).T, atol=1e-7)
