"""Splines through waypoints, by the rules of ROS's joint_trajectory_controller."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from numpy.polynomial.polynomial import polyder, polyval

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Waypoint:
    """Where joints are to be at a time [s].

    `state` has the positions of n joints, or those and velocities, or also accelerations: shape (1, n),
    (2, n) or (3, n), in [rad] or [m], per [s] and [s²].
    """

    seconds: float
    state: Floats


def sample(waypoints: Sequence[Waypoint], seconds: float) -> Floats:
    """Return positions, velocities and accelerations at a time, shape (3, n).

    Two waypoints are joined by lines; by cubics, if both have velocities; by quintics, if both have
    accelerations, too. Before the first and after the last one the joints are as these say.
    """
    later = next((i for i, waypoint in enumerate(waypoints) if seconds < waypoint.seconds), len(waypoints))
    if later in (0, len(waypoints)):
        state = waypoints[max(later - 1, 0)].state
        return np.vstack([state, np.zeros((3 - len(state), state.shape[1]))])
    start, end = waypoints[later - 1], waypoints[later]
    given = min(len(start.state), len(end.state))
    ends = np.vstack([start.state[:given], end.state[:given]])
    powers = _fit(given, end.seconds - start.seconds) @ ends
    since = seconds - start.seconds
    return np.array([polyval(since, polyder(powers, order)) for order in range(3)])


@lru_cache(maxsize=64)
def _fit(given: int, duration: float) -> Floats:
    """The matrix from the derivatives given at both ends to the polynomial's coefficients."""
    monomials = np.eye(2 * given)
    ends = [polyval(end, polyder(monomials, order)) for end in (0.0, duration) for order in range(given)]
    return np.linalg.inv(ends)
