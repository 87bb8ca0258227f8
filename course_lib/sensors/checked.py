"""Validation of settings and poses, which the rest of this room trusts."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from course_lib.arrays import Floats
from course_lib.errors import CourseError

_EYE = np.eye(3)
PoseAt = Callable[[float], ArrayLike]  # robot time since the start of the run [s] -> (4, 4)
Pose = ArrayLike | PoseAt


def check_number(
    name: str, value: Any, *, above: float = -np.inf, low: float = -np.inf, high: float = np.inf
) -> float:
    """Return a finite number that is greater than `above` and lies in [low, high].

    Raises:
        CourseError: If it is not; the message says what came in and what would have been right.
    """
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = np.nan
    if not (np.isfinite(number) and number > above and low <= number <= high):
        limits = ((">", above), (">=", low), ("<=", high))
        wanted = " and ".join(f"{sign} {limit:g}" for sign, limit in limits if np.isfinite(limit))
        raise CourseError(f"{name} is {value!r}; give a number{' ' + wanted if wanted else ''}.")
    return number


def check_count(name: str, value: Any) -> int:
    """Return a whole number of at least 1; raises a CourseError for anything else."""
    if not isinstance(value, int | np.integer) or isinstance(value, bool) or value < 1:
        raise CourseError(f"{name} is {value!r}; give a whole number, 1 or more.")
    return int(value)


def check_limits(name: str, unit: str, low: Any, high: Any) -> tuple[float, float]:
    """Return two numbers with low < high; raises a CourseError for anything else."""
    lower = check_number(f"{name}_min [{unit}]", low)
    return lower, check_number(f"{name}_max [{unit}]", high, above=lower)


def check_array(name: str, value: ArrayLike, shape: tuple[int, ...]) -> Floats:
    """Return a read-only array of finite float64 numbers of a shape; -1 stands for any length.

    Raises:
        CourseError: If the shape differs or a number is not finite.
    """
    try:
        array = np.array(value, float)
    except (TypeError, ValueError):
        raise CourseError(f"{name} is {value!r}; give numbers of shape {shape}.") from None
    wanted = tuple(got if want == -1 else want for got, want in zip(array.shape, shape, strict=False))
    if array.ndim != len(shape) or array.shape != wanted:
        raise CourseError(f"{name} has shape {array.shape}; give numbers of shape {shape}.")
    if not np.isfinite(array).all():
        raise CourseError(f"{name} holds {array[~np.isfinite(array)][0]}; give finite numbers.")
    array.setflags(write=False)
    return array


def check_transform(name: str, value: ArrayLike) -> Floats:
    """Return a rigid transform, shape (4, 4), translation in [m].

    Raises:
        CourseError: If it is not one; the message says which part failed.
    """
    matrix = check_array(name, value, (4, 4))
    rotation = matrix[:3, :3]
    if matrix[3].tolist() != [0, 0, 0, 1]:
        raise CourseError(f"The last row of {name} is {matrix[3].tolist()}; it must be [0, 0, 0, 1].")
    if np.abs(rotation @ rotation.T - _EYE).max() > 1e-6 or _determinant(rotation) < 0:
        raise CourseError(
            f"The upper left 3x3 of {name} is {rotation.round(4).tolist()}, no rotation: its columns "
            "must have length 1, be at right angles and right-handed. Start from numpy.eye(4)."
        )
    return matrix


def _determinant(matrix: Floats) -> float:
    """Return that of a matrix of shape (3, 3); numpy's takes ten times as long for one so small."""
    (a, b, c), (d, e, f), (g, h, i) = matrix.tolist()
    return float(a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g))


def check_rays(value: ArrayLike) -> Floats:
    """Return unit vectors as columns, shape (3, N), N > 0; raises a CourseError for anything else."""
    rays = np.asarray(value, float)
    if rays.ndim != 2 or rays.shape[0] != 3 or not rays.shape[1]:
        raise CourseError(f"rays have shape {rays.shape}; give one or more as columns, shape (3, N).")
    square = np.einsum("ij,ij->j", rays, rays)
    if not (np.abs(square - 1) <= 1e-6).all():  # also where one is NaN
        worst = rays[:, np.nanargmax(np.where(np.isnan(square), np.inf, np.abs(square - 1)))]
        raise CourseError(
            f"A ray is {worst.tolist()}; divide rays by their length: rays / norm(rays, axis=0)."
        )
    return rays


@dataclass(frozen=True)
class Motion:
    """A function of robot time [s] to transforms that are rigid by construction, so nobody checks them."""

    at: Callable[[float], Floats]

    def __call__(self, seconds: float) -> Floats:
        """Return the transform at a robot time, [s]."""
        return self.at(seconds)


def pose_function(name: str, pose: Pose) -> Callable[[float], Floats]:
    """Return a function of robot time [s] to checked transforms, from a fixed pose or a function."""
    if isinstance(pose, Motion):
        return pose.at
    if callable(pose):
        return lambda seconds: check_transform(f"{name} at {seconds:g} s", pose(seconds))
    fixed = check_transform(name, pose)
    return lambda seconds: fixed
