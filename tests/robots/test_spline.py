import numpy as np
import numpy.typing as npt
import pytest
from numpy.polynomial import Polynomial

from course_lib.robots.trajectory import Waypoint, sample

Floats = npt.NDArray[np.float64]
RANDOM = np.random.default_rng(0)


def of(polynomial: Polynomial, seconds: float, given: int) -> Floats:
    """Return the first `given` of a polynomial's value and derivatives at a time, for one joint."""
    return np.array(
        [[polynomial.deriv(order)(seconds) if order else polynomial(seconds)] for order in range(given)]
    )


@pytest.mark.parametrize("given", [1, 2, 3])
@pytest.mark.parametrize("duration", [0.02, 1.5, 30.0])
def test_linear_cubic_and_quintic_segments_are_reproduced_exactly(given: int, duration: float) -> None:
    wanted = Polynomial(RANDOM.normal(size=2 * given))
    ends = [Waypoint(seconds, of(wanted, seconds, given)) for seconds in (0.5, 0.5 + duration)]
    for seconds in np.linspace(0.5, 0.5 + duration, 7)[:-1]:
        np.testing.assert_allclose(sample(ends, seconds), of(wanted, seconds, 3), rtol=1e-9, atol=1e-9)


def test_endpoint_with_fewer_derivatives_determines_the_degree() -> None:
    ends = [Waypoint(0.0, np.array([[0.0], [7.0], [7.0]])), Waypoint(2.0, np.array([[1.0]]))]
    np.testing.assert_allclose(sample(ends, 0.5), [[0.25], [0.5], [0.0]], atol=1e-12)


def test_positions_and_velocities_are_continuous_between_cubics() -> None:
    waypoints = [Waypoint(float(time), RANDOM.normal(size=(2, 6))) for time in range(4)]
    for time in (1.0, 2.0):
        before, at = sample(waypoints, time - 1e-9), sample(waypoints, time)
        np.testing.assert_allclose(before[:2], at[:2], atol=1e-7)


def test_positions_outside_the_trajectory_equal_its_endpoints() -> None:
    first, last = np.array([[1.0, 2.0]]), np.array([[3.0, 4.0], [0.5, 0.5]])
    waypoints = [Waypoint(1.0, first), Waypoint(2.0, last)]
    assert sample(waypoints, 0.0).tolist() == [[1.0, 2.0], [0.0, 0.0], [0.0, 0.0]]
    assert sample(waypoints, 9.0).tolist() == [[3.0, 4.0], [0.5, 0.5], [0.0, 0.0]]
