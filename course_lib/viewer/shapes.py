"""Unit shapes as triangles, for pictures that are made without a graphics library."""

from functools import cache
from typing import NamedTuple

import numpy as np

from course_lib.arrays import Float32s, Matrix
from course_lib.viewer.drawables import Shape, Spot

_ARC = np.linspace(-np.pi / 2, np.pi / 2, 33)

# (radius, height) from the bottom to the top, to be turned around z.
_PROFILES: dict[Shape, Matrix] = {
    "box": np.array([(0, -0.5), (0.5**0.5, -0.5), (0.5**0.5, 0.5), (0, 0.5)]),
    "sphere": np.column_stack([np.cos(_ARC), np.sin(_ARC)]) / 2,
    "cylinder": np.array([(0, -0.5), (0.5, -0.5), (0.5, 0.5), (0, 0.5)]),
    "cone": np.array([(0, -0.5), (0.5, -0.5), (0, 0.5)]),
}

_CORNERS = [(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)]
SQUARE = np.array(_CORNERS, np.float32)[[[0, 1, 2], [0, 2, 3]]]  # two triangles, shape (2, 3, 3)
_BOX_SHADES = np.array([(0.6, 0.6), (0.4, 1.0), (0.9, 0.5)], np.float32)  # of the sides +x -x, +y -y, +z -z
_DISC_SHADES = np.array([[1.0], [0.8], [0.8]], np.float32)  # of its middle and its rim


class Surface(NamedTuple):
    """Triangles that share nothing: corners and normals, both of shape (T, 3, 3)."""

    corners: Float32s
    normals: Float32s


@cache
def unit_shape(shape: Shape, steps: int) -> Surface:
    """Return a shape as `Solids` describes it, with that many corners around its axis; a box has four."""
    profile, steps = _PROFILES[shape], 4 if shape == "box" else steps
    angles = (np.arange(steps + 1) + 0.5) * 2 * np.pi / steps
    corners = _quads(_turned(profile[:-1], angles), _turned(profile[1:], angles))
    if shape == "sphere":
        return Surface(corners, corners)
    if shape == "box":
        flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        return Surface(corners, flat[:, None].repeat(3, axis=1))
    outward = _turned(np.diff(profile, axis=0)[:, ::-1] * [1, -1], angles)
    return Surface(corners, _quads(outward, outward))


@cache
def unit_spot(spot: Spot) -> tuple[Float32s, Float32s]:
    """Return triangles, shape (T, 3, 3), and how bright RViz makes their corners, shape (T, 3, 1).

    The numbers are those of RViz's shaders: shaded_circle.frag and nogp/box.frag.
    """
    if spot in ("square", "tile"):
        return SQUARE, np.ones((2, 3, 1), np.float32)
    if spot in ("disc", "sphere"):
        steps, shades = (24, _DISC_SHADES) if spot == "sphere" else (8, np.ones_like(_DISC_SHADES))
        angles = np.linspace(0, 2 * np.pi, steps + 1, dtype=np.float32)
        rim = np.column_stack([np.cos(angles) / 2, np.sin(angles) / 2, 0 * angles]).astype(np.float32)
        return np.stack([0 * rim[1:], rim[:-1], rim[1:]], axis=1), np.tile(shades, (steps, 1, 1))
    corners, normals = unit_shape("box", 4)
    negative = (normals.sum(axis=-1) < 0).astype(int)
    return corners, _BOX_SHADES[np.abs(normals).argmax(axis=-1), negative][..., None]


def _turned(profile: Matrix, angles: Matrix) -> Float32s:
    """Turn points (radius, height), shape (S, 2), around z; returns shape (A, S, 3)."""
    radius, height = profile.T
    x, y = np.outer(np.cos(angles), radius), np.outer(np.sin(angles), radius)
    return np.stack([x, y, np.broadcast_to(height, x.shape)], axis=-1).astype(np.float32)


def _quads(low: Float32s, high: Float32s) -> Float32s:
    """Join what was turned, at the lower and upper ends of segments, to triangles, shape (T, 3, 3)."""
    corners = [low[:-1], low[1:], high[1:], low[:-1], high[1:], high[:-1]]
    return np.stack(corners, axis=2).reshape(-1, 3, 3)
