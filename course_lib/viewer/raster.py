"""Which samples of a picture a triangle covers."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from course_lib.arrays import Float32s, Floats, Indices

_AT_ONCE = 500_000  # samples


class Covered(NamedTuple):
    """Samples inside triangles."""

    sample: Indices  # numbers of samples in the picture, row by row, shape (N,)
    triangle: Indices  # numbers of the triangles, shape (N,)
    share: Floats  # share of each corner at the sample, shape (N, 3)


def covered(xy: Floats, size: tuple[int, int]) -> Iterator[Covered]:
    """Iterate over the samples whose centres are in triangles.

    Args:
        xy: Corners in samples, x right and y down, shape (T, 3, 2).
        size: Width and height of the picture in samples.
    """
    width, height = size
    low = np.ceil(xy[..., 1].min(axis=1) - 0.5).clip(0, height).astype(int)
    high = np.ceil(xy[..., 1].max(axis=1) - 0.5).clip(0, height).astype(int)
    triangle, y = _expanded(low, high)
    slope, offset = _edges(xy)
    slope, offset = slope[triangle], offset[triangle, :, 0] + offset[triangle, :, 1] * (y[:, None] + 0.5)
    crossing = -offset / np.where(slope == 0, 1, slope)  # a share is positive on one side of where it is zero
    first = np.where(slope > 0, crossing, -np.inf).max(axis=1)
    last = np.where(slope < 0, crossing, np.inf).min(axis=1)
    outside = ((slope == 0) & (offset < 0)).any(axis=1)
    left = np.ceil(first - 0.5).clip(0, width)
    right = np.where(outside, 0, np.ceil(last - 0.5).clip(0, width))
    ends = np.cumsum(np.maximum(right - left, 0))
    for chunk in np.split(
        np.arange(len(y)), np.searchsorted(ends, np.arange(_AT_ONCE, ends[-1:].sum(), _AT_ONCE))
    ):
        row, x = _expanded(left[chunk].astype(int), right[chunk].astype(int))
        row = chunk[row]
        share = slope[row] * (x[:, None] + 0.5) + offset[row]
        yield Covered(y[row] * width + x, triangle[row], share)


def clipped(corners: Float32s, near: float) -> Float32s:
    """Cut away what is nearer to the camera than that; corners of shape (T, 3, K) begin with x, y, z."""
    inside = -corners[..., 2] >= near
    count = inside.sum(axis=1)
    pieces = [corners[count == 3]]
    for inner, build in ((1, ("A", "AB", "AC")), (2, ("AB", "B", "C", "AB", "C", "AC"))):
        some, inside_of_some = corners[count == inner], inside[count == inner]
        odd = np.argmax(inside_of_some == (inner == 1), axis=1)  # the corner that is alone on its side
        a, b, c = (some[np.arange(len(some)), (odd + turn) % 3] for turn in range(3))
        points = {"A": a, "B": b, "C": c, "AB": _cut(a, b, near), "AC": _cut(a, c, near)}
        built = np.stack([points[name] for name in build], axis=1)
        pieces.append(built.reshape(-1, 3, corners.shape[2]))
    return np.concatenate(pieces)


def _cut(a: Float32s, b: Float32s, near: float) -> Float32s:
    """Return the points between two at which the picture begins, shape (N, K)."""
    part: Float32s = (-near - a[:, 2:3]) / (b[:, 2:3] - a[:, 2:3])
    return a + part * (b - a)


def _edges(xy: Floats) -> tuple[Floats, Floats]:
    """Return the share of each corner at a point as slope * x + offset[0] + offset[1] * y."""
    this, other = np.roll(xy, -1, axis=1), np.roll(xy, -2, axis=1)
    rise, run = this[..., 1] - other[..., 1], other[..., 0] - this[..., 0]
    area = rise * (xy[..., 0] - other[..., 0]) + run * (xy[..., 1] - other[..., 1])
    flat = ~(np.abs(area) > 1e-9)  # also of what is not a number
    area[flat] = 1
    slope = np.where(flat, 0, rise / area)
    start = np.where(flat, -1, -(rise * other[..., 0] + run * other[..., 1]) / area)  # no share anywhere
    return slope, np.stack([start, np.where(flat, 0, run / area)], axis=-1)


def _expanded(start: Indices, stop: Indices) -> tuple[Indices, Indices]:
    """Return all numbers of many ranges, after the number of the range that each is from."""
    count = np.maximum(stop - start, 0)
    source = np.repeat(np.arange(len(start)), count)
    within = np.arange(len(source)) - np.repeat(np.cumsum(count) - count, count)
    return source, start[source] + within
