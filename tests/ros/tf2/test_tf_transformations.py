"""Against pinocchio, whose rotations share nothing with transforms3d."""

from math import pi

import numpy as np
import pytest
import tf_transformations as tf
from hypothesis import given
from hypothesis import strategies as st

pin = pytest.importorskip("pinocchio")

angles = st.floats(-3.1, 3.1)
tilts = st.floats(-1.5, 1.5)  # [rad] short of the singular pi / 2


@given(angles, tilts, angles)
def test_default_axes_are_roll_pitch_yaw(roll: float, pitch: float, yaw: float) -> None:
    expected = pin.rpy.rpyToMatrix(roll, pitch, yaw)
    np.testing.assert_allclose(tf.euler_matrix(roll, pitch, yaw)[:3, :3], expected, atol=1e-12)
    quaternion = tf.quaternion_from_euler(roll, pitch, yaw)
    np.testing.assert_allclose(pin.Quaternion(quaternion).matrix(), expected, atol=1e-12)  # x, y, z, w
    np.testing.assert_allclose(tf.euler_from_quaternion(quaternion), (roll, pitch, yaw), atol=1e-9)


@pytest.mark.slow
@given(angles, tilts, angles)
def test_rotating_axes_equal_static_axes_in_reverse_order(a: float, b: float, c: float) -> None:
    np.testing.assert_allclose(tf.euler_matrix(a, b, c, "rzyx"), tf.euler_matrix(c, b, a, "sxyz"), atol=1e-12)
    found = tf.euler_from_quaternion(tf.quaternion_from_euler(a, b, c, "rzyx"), axes="rzyx")
    np.testing.assert_allclose(found, (a, b, c), atol=1e-9)


@given(angles, tilts, angles, angles, tilts, angles)
def test_right_quaternion_factor_is_applied_first(
    a: float, b: float, c: float, d: float, e: float, f: float
) -> None:
    one, two = tf.quaternion_from_euler(a, b, c), tf.quaternion_from_euler(d, e, f)
    product = (pin.Quaternion(one) * pin.Quaternion(two)).coeffs()
    np.testing.assert_allclose(tf.quaternion_multiply(one, two), product, atol=1e-12)
    back = tf.quaternion_multiply(tf.quaternion_inverse(one), one)
    np.testing.assert_allclose(back, (0, 0, 0, 1), atol=1e-12)


@given(angles, tilts, angles, st.floats(0.0, 1.0))
def test_slerp_takes_the_shorter_arc(a: float, b: float, c: float, fraction: float) -> None:
    start, end = np.array([0.0, 0.0, 0.0, 1.0]), tf.quaternion_from_euler(a, b, c)
    between = pin.Quaternion(start).slerp(fraction, pin.Quaternion(end)).coeffs()
    np.testing.assert_allclose(tf.quaternion_slerp(start, end, fraction), between, atol=1e-6)


def test_matrix_quaternion_and_euler_conversions_agree() -> None:
    quaternion = tf.quaternion_about_axis(0.7, (1.0, 2.0, -1.0))
    matrix = tf.quaternion_matrix(quaternion)
    np.testing.assert_allclose(tf.quaternion_from_matrix(matrix), quaternion, atol=1e-12)
    np.testing.assert_allclose(tf.rotation_matrix(0.7, (1.0, 2.0, -1.0)), matrix, atol=1e-12)
    assert tf.euler_from_matrix(tf.euler_matrix(0.1, 0.2, 0.3)) == pytest.approx((0.1, 0.2, 0.3))


def test_last_concatenated_transform_is_applied_first() -> None:
    both = tf.concatenate_matrices(tf.translation_matrix((1, 0, 0)), tf.euler_matrix(0, 0, pi / 2))
    np.testing.assert_allclose(both @ (1, 0, 0, 1), (1, 1, 0, 1), atol=1e-12)
    np.testing.assert_allclose(tf.translation_from_matrix(both), (1, 0, 0))
    back = tf.concatenate_matrices(both, tf.inverse_matrix(both))
    np.testing.assert_allclose(back, np.eye(4), atol=1e-12)


def test_vector_norm_and_unit_vector_are_computed() -> None:
    assert tf.vector_norm((3.0, 4.0)) == 5.0
    np.testing.assert_allclose(tf.unit_vector((3.0, 4.0)), (0.6, 0.8))
    np.testing.assert_array_equal(tf.quaternion_conjugate((1, 2, 3, 4)), (-1, -2, -3, 4))
