"""Pictures made with numpy alone, where no browser is: triangles, a depth for each pixel, blending."""

from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from typing import NamedTuple, TypeAlias

import numpy as np
from PIL import Image

from course_lib.arrays import Bytes, Float32s, Floats, Indices, Pixels
from course_lib.viewer.camera import Camera
from course_lib.viewer.drawables import Inset
from course_lib.viewer.scene import Scene
from course_lib.viewer.triangles import Triangles, triangles_of

Box: TypeAlias = tuple[int, int, int, int]  # left, top, width, height in [px]

SHARE, GAP = 0.3, 0.01  # of the view's width: how wide a picture is, how far it is from others


def placed_insets(scene: Scene, size: tuple[int, int]) -> Iterator[tuple[Inset, Box]]:
    """Iterate over the pictures that are shown, one below the other at the right; smaller if many are."""
    things = scene.objects().items()
    insets = [thing for path, thing in sorted(things) if isinstance(thing, Inset) and scene.visible(path)]
    width, gap = SHARE * size[0], GAP * size[0]
    needed = sum(width / inset.aspect for inset in insets)
    shrink = min(1.0, (size[1] - gap * (len(insets) + 1)) / needed) if needed else 1.0
    left, top = size[0] - gap - width * shrink, gap
    for inset in insets:
        height = width / inset.aspect * shrink
        yield inset, (round(left), round(top), max(round(width * shrink), 1), max(round(height), 1))
        top += height + gap


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


_FINER = 2  # samples per pixel along each axis


@dataclass(frozen=True)
class Fragments:
    """Samples of triangles: which sample of the picture, how far away [m], RGBA; all of length N."""

    sample: Indices
    depth: Float32s
    color: Float32s


def draw(scene: Scene, size: tuple[int, int]) -> bytes:
    """Draw a scene, with the pictures in its corner, and return the PNG; the size is in pixels."""
    with np.errstate(invalid="ignore", over="ignore"):  # NaN covers no pixel
        pixels = _pixels(scene, scene.camera, size)
        for inset, (left, top, width, height) in placed_insets(scene, size):
            pixels[top : top + height, left : left + width] = _inset(scene, inset, (width, height))
    png = BytesIO()
    Image.fromarray(pixels).save(png, "png")
    return png.getvalue()


def _inset(scene: Scene, inset: Inset, size: tuple[int, int]) -> Pixels:
    """Draw a picture into its place, with the scene if it shows that too."""
    picture = np.asarray(Image.fromarray(inset.pixels).resize(size))
    if inset.camera is None:
        return picture
    drawn = _pixels(scene, inset.camera, size, picture if inset.behind else None, inset.hidden)
    mixed: Pixels = np.rint(drawn * (1 - inset.over) + picture * inset.over).astype(np.uint8)
    return mixed


def _pixels(
    scene: Scene,
    camera: Camera,
    size: tuple[int, int],
    behind: Pixels | None = None,
    hidden: tuple[str, ...] = (),
) -> Pixels:
    """Draw all objects in RViz's order, as the page does.

    That is: what is behind everything, what is opaque by depth, what is transparent from far to near. Lines
    and points are triangles here, and take part like surfaces.
    """
    width, height = size[0] * _FINER, size[1] * _FINER
    depths = np.full(width * height, np.inf, np.float32)
    if behind is None:
        behind = np.broadcast_to(np.array(scene.background, np.uint8), (size[1], size[0], 3))
    fine_behind = behind.repeat(_FINER, axis=0).repeat(_FINER, axis=1)
    colors = fine_behind.reshape(-1, 3).astype(np.float32) / np.float32(255)
    seen_through: list[Fragments] = []
    for triangles in triangles_of(scene, camera, size[1], hidden):
        for fragments in _fragments(triangles, camera, (width, height)):
            if triangles.behind:
                _blend(depths, colors, [fragments])
            elif triangles.transparent:
                seen_through.append(fragments)
            else:
                _cover(depths, colors, fragments)
    _blend(depths, colors, seen_through)
    fine = colors.reshape(size[1], _FINER, size[0], _FINER, 3)
    pixels: Pixels = np.rint(fine.mean(axis=(1, 3)) * 255).astype(np.uint8)
    return pixels


def _cover(depths: Float32s, colors: Float32s, fragments: Fragments) -> None:
    """Keep the nearest fragment of each sample."""
    order = np.argsort(-fragments.depth, kind="stable")
    order = order[fragments.depth[order] < depths[fragments.sample[order]]]
    sample = fragments.sample[order]  # the last one written is the nearest
    depths[sample] = fragments.depth[order]
    colors[sample] = fragments.color[order, :3]


def _blend(depths: Float32s, colors: Float32s, parts: list[Fragments]) -> None:
    """Lay fragments over what is behind them, the farthest first."""
    if not parts:
        return
    sample = np.concatenate([part.sample for part in parts])
    depth = np.concatenate([part.depth for part in parts])
    color = np.concatenate([part.color for part in parts])
    order = np.lexsort((-depth, sample))
    order = order[depth[order] < depths[sample[order]]]
    sample, color = sample[order], color[order]
    first = np.flatnonzero(np.diff(sample, prepend=-1))
    layer = np.arange(len(sample)) - np.repeat(first, np.diff(first, append=len(sample)))
    for number in range(layer.max(initial=-1) + 1):
        now = np.flatnonzero(layer == number)
        alpha = color[now, 3:]
        colors[sample[now]] = colors[sample[now]] * (1 - alpha) + color[now, :3] * alpha


def _fragments(triangles: Triangles, camera: Camera, size: tuple[int, int]) -> Iterator[Fragments]:
    """Iterate over the samples that triangles cover, a few at a time."""
    perspective = camera.orthographic_scale is None
    corners = clipped(triangles.corners, camera.near) if perspective else triangles.corners
    depth = -corners[..., 2:3]
    scale = camera.pixels_per_metre(depth, size[1]) * (1 if perspective else _FINER)
    middle = np.array(size) / 2 + np.array(camera.shift) * size[1]
    xy = middle + corners[..., :2] * scale * [1, -1]
    weight = 1 / depth if perspective else np.ones_like(depth)
    values = np.concatenate([depth, corners[..., 3:]], axis=-1) * weight
    for spans in covered(xy, size):
        share = spans.share.astype(np.float32)[:, None]
        total = (share @ weight[spans.triangle])[:, 0]
        value = (share @ values[spans.triangle])[:, 0] / total
        value[:, 0] *= 1 + triangles.farther
        yield _shaded(spans.sample, value, triangles.mask)


def _shaded(sample: Indices, value: Float32s, mask: Bytes | None) -> Fragments:
    """Split interpolated values into depth and colour, and thin the colour by the mask."""
    depth, color, place = value[:, 0], value[:, 1:5], value[:, 5:]
    if mask is None:
        return Fragments(sample, depth, color)
    rows, columns = mask.shape[:2]
    row = ((1 - place[:, 1]) * rows).astype(int).clip(0, rows - 1)
    column = (place[:, 0] * columns).astype(int).clip(0, columns - 1)
    ink = mask[row, column].reshape(len(row), mask.size // (rows * columns))
    color[:, -ink.shape[1] :] *= ink / np.float32(255)
    inked = color[:, 3] > 0.01
    return Fragments(sample[inked], depth[inked], color[inked])
