"""Solids and the distances at which rays meet them, from outside and inside."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from course_lib.arrays import Floats
from course_lib.sensors.checked import check_number


@dataclass(frozen=True, eq=False)
class Shape:
    """A shape in its own frame; made by `box`, `sphere`, `cylinder` or `plane`.

    Args:
        size: Edges of the box around it, centred on its frame, shape (3,), [m].
        reach: Radius of the sphere around it, centred on its frame, [m].
        distances: Casts rays. Takes where they all begin, shape (3,), [m], and unit vectors as columns,
            shape (3, N), both in the shape's frame; gives distances, shape (N,), [m], inf for a miss.
    """

    size: Floats
    reach: float
    distances: Callable[[Floats, Floats], Floats]


def box(x: float, y: float, z: float) -> Shape:
    """Return a box with edges x, y, z [m], centred."""
    edges = (("x", x), ("y", y), ("z", z))
    size = np.array([check_number(f"{axis} [m] of a box", edge, above=0) for axis, edge in edges])

    def distances(origin: Floats, rays: Floats) -> Floats:
        return _first_met(*_between_walls(origin, rays, size / 2))

    return Shape(size, float(np.linalg.norm(size)) / 2, distances)


def sphere(radius: float) -> Shape:
    """Return a ball with a radius [m], centred."""
    radius = check_number("radius [m] of a sphere", radius, above=0)

    def distances(origin: Floats, rays: Floats) -> Floats:
        return _first_met(*_within_radius(origin, rays, radius))

    return Shape(np.full(3, 2 * radius), radius, distances)


def cylinder(radius: float, height: float) -> Shape:
    """Return a closed cylinder along z with a radius and a height [m], centred."""
    radius = check_number("radius [m] of a cylinder", radius, above=0)
    height = check_number("height [m] of a cylinder", height, above=0)

    def distances(origin: Floats, rays: Floats) -> Floats:
        enter, leave = _within_radius(origin[:2], rays[:2], radius)
        top, bottom = _between_walls(origin[2:], rays[2:], np.array([height / 2]))
        return _first_met(np.maximum(enter, top), np.minimum(leave, bottom))

    return Shape(np.array([2 * radius, 2 * radius, height]), float(np.hypot(radius, height / 2)), distances)


def plane() -> Shape:
    """Return the infinite plane z = 0, visible from both sides."""

    def distances(origin: Floats, rays: Floats) -> Floats:
        with np.errstate(divide="ignore", invalid="ignore"):
            along = -origin[2] / rays[2]
        return np.where((along >= 0) & np.isfinite(along), along, np.inf)

    return Shape(np.array([np.inf, np.inf, 0.0]), np.inf, distances)


def _between_walls(origin: Floats, rays: Floats, half: Floats) -> tuple[Floats, Floats]:
    """Return the distances at which rays enter and leave |x| <= half, in any number of dimensions."""
    with np.errstate(divide="ignore", invalid="ignore"):  # along a wall: 0 * inf is left out by fmin, fmax
        slopes = 1 / rays
        low, high = (-half - origin)[:, None] * slopes, (half - origin)[:, None] * slopes
    return np.fmin(low, high).max(axis=0), np.fmax(low, high).min(axis=0)


def _within_radius(origin: Floats, rays: Floats, radius: float) -> tuple[Floats, Floats]:
    """Return the distances at which rays enter and leave the ball (3 rows) or infinite cylinder (2 rows)."""
    square = np.einsum("ij,ij->j", rays, rays)
    along_axis = square < 1e-18
    square[along_axis] = 1
    nearest = -(origin @ rays) / square
    # The squared distance at the nearest point: no difference of large numbers as in b^2 - 4ac.
    gap = radius**2 - ((origin[:, None] + nearest * rays) ** 2).sum(axis=0)
    half = np.sqrt(np.where(gap < 0, np.nan, gap) / square)  # comparisons with NaN are False: a miss
    half[along_axis & (gap >= 0)] = np.inf
    return nearest - half, nearest + half


def _first_met(enter: Floats, leave: Floats) -> Floats:
    """Return the first distance ahead of rays that enter and leave a convex solid, inf for a miss."""
    ahead = np.where(enter >= 0, enter, leave)
    return np.where((enter <= leave) & (leave >= 0), ahead, np.inf)
