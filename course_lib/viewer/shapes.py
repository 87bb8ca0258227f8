"""Unit shapes as triangles, for pictures that are made without a graphics library."""

from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np

from course_lib.viewer.arrays import Floats
from course_lib.viewer.drawables import Shape


class Surface(NamedTuple):
    """Triangles that share nothing: corners and unit normals, both of shape (T, 3, 3)."""

    corners: Floats
    normals: Floats


@cache
def unit_shape(shape: Shape, steps: int) -> Surface:
    """Return a shape as `Solids` describes it, with that many corners around its axis."""
    return _box() if shape == "box" else _revolved(*_PROFILES[shape](steps // 2), steps)


def _box() -> Surface:
    """Return the cube: two triangles on each side of each axis."""
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]]) / 2
    corners, normals = np.zeros((6, 6, 3)), np.zeros((6, 6, 3))
    for side, (axis, sign) in enumerate(product(range(3), (-1, 1))):
        corners[side, :, [(axis + 1) % 3, (axis + 2) % 3]] = square.T * [[sign], [1]]
        corners[side, :, axis] = sign / 2
        normals[side, :, axis] = sign
    return _surface(corners, normals)


def _revolved(profile: Floats, normals: Floats, steps: int) -> Surface:
    """Turn a profile around z; both arrays are (S, 2, 2): segments, their two ends, radius and height."""
    angles = np.linspace(0, 2 * np.pi, steps + 1)
    turned = [
        np.stack(
            [part[..., 0] * np.cos(angles)[:, None, None], part[..., 0] * np.sin(angles)[:, None, None],
             np.broadcast_to(part[..., 1], (steps + 1, *part.shape[:2]))], axis=-1)
        for part in (profile, normals)
    ]  # fmt: skip
    here, there = slice(None, -1), slice(1, None)
    quads = [(here, 0), (there, 0), (there, 1), (here, 0), (there, 1), (here, 1)]
    corners, directions = (np.stack([ring[turn, :, end] for turn, end in quads], axis=2) for ring in turned)
    return _surface(corners, directions)


def _surface(corners: np.ndarray, normals: np.ndarray) -> Surface:
    return Surface(corners.reshape(-1, 3, 3).astype(np.float32), normals.reshape(-1, 3, 3).astype(np.float32))


def _sphere(rings: int) -> tuple[np.ndarray, np.ndarray]:
    angles = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    points = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    normals = np.stack([points[:-1], points[1:]], axis=1)
    return normals / 2, normals


def _cylinder(_: int) -> tuple[np.ndarray, np.ndarray]:
    profile = np.array([[[0, -1], [1, -1]], [[1, -1], [1, 1]], [[1, 1], [0, 1]]]) / 2
    return profile, np.repeat(np.array([[[0, -1]], [[1, 0]], [[0, 1]]]), 2, axis=1)


def _cone(_: int) -> tuple[np.ndarray, np.ndarray]:
    profile = np.array([[[0, -1], [1, -1]], [[1, -1], [0, 1]]]) / 2
    return profile, np.repeat(np.array([[[0, -1]], [[2, 1] / np.sqrt(5)]]), 2, axis=1)


_PROFILES = {"sphere": _sphere, "cylinder": _cylinder, "cone": _cone}
