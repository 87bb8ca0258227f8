"""Images of a scene, rendered by Chromium or Chrome if available, else by numpy alone.

For numpy, all drawables are converted to triangles in the camera's frame, colored by RViz's light.
A depth buffer with four samples per pixel keeps the nearest ones, and transparent samples are
blended back to front.
"""

import base64
import contextlib
import os
import re
import shutil
import signal
import struct
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
from PIL import Image

from course_lib.arrays import Bools, Bytes, Float32s, Floats, Indices, Matrix, Pixels
from course_lib.errors import CourseError
from course_lib.files import save_as
from course_lib.viewer import drawables, encoding, html
from course_lib.viewer.scene import Scene

_ARC = np.linspace(-np.pi / 2, np.pi / 2, 33)

# (radius, height) from bottom to top, to be revolved around z.
_PROFILES: dict[drawables.Shape, Matrix] = {
    "box": np.array([(0, -0.5), (0.5**0.5, -0.5), (0.5**0.5, 0.5), (0, 0.5)]),
    "sphere": np.column_stack([np.cos(_ARC), np.sin(_ARC)]) / 2,
    "cylinder": np.array([(0, -0.5), (0.5, -0.5), (0.5, 0.5), (0, 0.5)]),
    "cone": np.array([(0, -0.5), (0.5, -0.5), (0, 0.5)]),
}

_CORNERS = [(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)]
# Two triangles, shape (2, 3, 3).
SQUARE = np.array(_CORNERS, np.float32)[[[0, 1, 2], [0, 2, 3]]]
# Brightness of the sides: +x -x, +y -y, +z -z.
_BOX_SHADES = np.array([(0.6, 0.6), (0.4, 1.0), (0.9, 0.5)], np.float32)
# Brightness of the corners of a disc's triangles: the center and two on the rim.
_DISC_SHADES = np.array([[1.0], [0.8], [0.8]], np.float32)


class Surface(NamedTuple):
    """Independent triangles: corners and normals, both of shape (T, 3, 3)."""

    corners: Float32s
    normals: Float32s


@cache
def unit_shape(shape: drawables.Shape, steps: int) -> Surface:
    """Return a shape as defined by `Solids`, with `steps` corners around its axis."""
    profile, steps = _PROFILES[shape], 4 if shape == "box" else steps
    angles = (np.arange(steps + 1) + 0.5) * 2 * np.pi / steps
    corners = _quads(_revolve(profile[:-1], angles), _revolve(profile[1:], angles))
    if shape == "sphere":
        return Surface(corners, corners)
    if shape == "box":
        flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        return Surface(corners, flat[:, None].repeat(3, axis=1))
    normals = _revolve(np.diff(profile, axis=0)[:, ::-1] * [1, -1], angles)
    return Surface(corners, _quads(normals, normals))


@cache
def unit_spot(spot: drawables.Spot) -> tuple[Float32s, Float32s]:
    """Return triangles, shape (T, 3, 3), and RViz's brightness at their corners, shape (T, 3, 1).

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


def _revolve(profile: Matrix, angles: Matrix) -> Float32s:
    """Rotate points (radius, height), shape (S, 2), around z by A angles; shape (A, S, 3)."""
    radius, height = profile.T
    x, y = np.outer(np.cos(angles), radius), np.outer(np.sin(angles), radius)
    return np.stack([x, y, np.broadcast_to(height, x.shape)], axis=-1).astype(np.float32)


def _quads(low: Float32s, high: Float32s) -> Float32s:
    """Connect the lower and upper ends of revolved segments by triangles, shape (T, 3, 3)."""
    corners = [low[:-1], low[1:], high[1:], low[:-1], high[1:], high[:-1]]
    return np.stack(corners, axis=2).reshape(-1, 3, 3)


# Like RViz's depth bias of 16 units at about 10 m.
_ON_SHEETS = 1e-3


@dataclass(frozen=True)
class Triangles:
    """The triangles of one object, in the camera's frame."""

    # x right, y up, -z ahead of the camera [m], then RGBA, then the coordinates in the mask, x
    # right and y up in 0..1; shape (T, 3, 9)
    corners: Float32s
    # Whether objects behind the triangles are visible through them.
    is_transparent: bool
    # factors 0..255 of the alpha, shape (rows, columns), or of each channel, shape (rows, columns,
    # 4); the first row is at the top
    mask: Bytes | None = None
    # Whether the triangles are behind all later objects.
    is_behind: bool = False
    # Depth bias as a fraction of the distance.
    farther: float = 0.0


@dataclass(frozen=True)
class Dots:
    """Squares or discs aligned with the image, for points too small to show another shape."""

    # x right, y up, -z ahead of the camera [m], shape (N, 3)
    centers: Float32s
    # RGBA, shape (N, 4)
    colors: Float32s
    # Diameters [m], shape (N,)
    diameters: Float32s
    is_transparent: bool
    is_round: bool
    is_behind: bool = False


@dataclass(frozen=True)
class Viewpoint:
    """The transform from an object to the camera, and the height of the image."""

    transform_object_to_camera: Matrix
    camera: drawables.Camera
    height: int

    def points(self, points: Float32s) -> Float32s:
        """Transform points, shape (..., 3), to the camera's frame."""
        transform = self.transform_object_to_camera
        return (points @ transform[:3, :3].T + transform[:3, 3]).astype(np.float32)

    def pixel(self, points: Float32s) -> Float32s:
        """Return the size of a pixel [m] at points in the camera's frame, shape (N, 1)."""
        depth = np.maximum(-points[:, 2:], self.camera.near)
        return (1 / self.camera.pixels_per_metre(depth, self.height)).astype(np.float32)


def triangles_of(
    scene: Scene, camera: drawables.Camera, height: int, hidden_paths: tuple[str, ...]
) -> Iterator[Triangles | Dots]:
    """Iterate over all visible objects in an image of a given height, except those at hidden paths.

    Objects that only three.js can draw, without an equivalent drawable, are left out.
    """
    transform_scene_to_camera = camera.view_matrix()
    without = tuple(f"{path}/" for path in hidden_paths)
    objects = scene.objects().items()
    ordered = sorted(objects, key=lambda item: not getattr(item[1], "is_behind", False))
    for path, drawable in ordered:
        drawable = getattr(drawable, "stand_in", None) or drawable
        if type(drawable) in _CONVERTERS and scene.is_visible(path) and not f"{path}/".startswith(without):
            transform = transform_scene_to_camera @ scene.world_transform(path)
            view = Viewpoint(transform, camera, height)
            if isinstance(drawable, drawables.Points) and len(drawable.points) >= _MANY_POINTS:
                dots, drawable = _split_points(drawable, view)
                yield dots
            triangles = _CONVERTERS[type(drawable)](drawable, view)
            is_near = (-triangles.corners[..., 2]).min(axis=1, initial=np.inf) <= camera.far
            yield triangles if is_near.all() else replace(triangles, corners=triangles.corners[is_near])


def _triangles(points: Float32s, colors: Float32s, lit_by: Float32s | None = None) -> Triangles:
    """Combine corners, shape (T, 3, 3), and colors, shape (T, 3, 4), shaded by normals."""
    colors = np.broadcast_to(colors, (*points.shape[:2], 4)).astype(np.float32)
    if lit_by is not None:
        length = np.linalg.norm(lit_by, axis=-1, keepdims=True)
        colors[..., :3] *= np.abs(lit_by[..., 2:]) / np.maximum(length, 1e-12)
    corners = np.concatenate([points, colors, np.zeros((*points.shape[:2], 2), np.float32)], axis=-1)
    return Triangles(corners, bool((colors[..., 3] < drawables.OPAQUE_FROM).any()))


def _normals(corners: Float32s) -> Float32s:
    """Return unnormalized normals of triangles, shape (T, 1, 3)."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, None]


def _transform_normals(normals: Float32s, transform: Matrix) -> Float32s:
    """Transform normals, shape (..., 3), by transforms that may scale or flatten, shape (..., 4, 4)."""
    x, y, z = (transform[..., :3, axis] for axis in range(3))
    cofactors = np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=-1)
    return (cofactors @ normals[..., None])[..., 0].astype(np.float32)


def _solids(solids: drawables.Solids, view: Viewpoint) -> Triangles:
    unit = unit_shape(solids.shape, 32 if len(solids.placements) < 50 else 12)
    placements = (view.transform_object_to_camera @ solids.placements)[:, None, None]
    points = (placements[..., :3, :3] @ unit.corners[..., None])[..., 0] + placements[..., :3, 3]
    corners = points.reshape(-1, 3, 3).astype(np.float32)
    normals = _transform_normals(unit.normals, placements).reshape(-1, 3, 3)
    each = np.broadcast_to(solids.colors, (len(points), 4))
    colors = np.repeat(each, len(unit.corners), axis=0)[:, None]
    front = _front(corners, view)
    return _triangles(corners[front], colors[front], normals[front] if solids.lit else None)


def _front(corners: Float32s, view: Viewpoint) -> Bools:
    """Return which triangles face the camera."""
    towards = [0, 0, 1] if view.camera.orthographic_scale else -corners[:, 0]
    front: Bools = (_normals(corners)[:, 0] * towards).sum(axis=-1) > 0
    return front


def _mesh(mesh: drawables.Mesh, view: Viewpoint) -> Triangles:
    points = view.points(mesh.vertices)[mesh.faces]
    colors = np.broadcast_to(mesh.colors, (len(mesh.vertices), 4))[mesh.faces]
    if not mesh.lit:
        return _triangles(points, colors)
    if mesh.normals is None:
        return _triangles(points, colors, _normals(points))
    return _triangles(
        points, colors, _transform_normals(mesh.normals, view.transform_object_to_camera)[mesh.faces]
    )


def _lines(lines: drawables.Lines, view: Viewpoint) -> Triangles:
    """Widen each segment perpendicular to the line between its neighbors, like Ogre's billboard chain."""
    points = view.points(lines.points)
    colors = np.broadcast_to(lines.colors, (len(points), 4))
    start = np.arange(0, max(len(points) - 1, 0), 1 if lines.strip else 2)
    before, after = start, start + 1
    if lines.strip:
        before, after = np.maximum(start - 1, 0), np.minimum(start + 2, len(points) - 1)
    ends = np.stack([points[start], points[start + 1]], axis=1)
    along = np.stack([points[start + 1] - points[before], points[after] - points[start]], axis=1)
    across = np.cross(along, [0, 0, 1] if view.camera.orthographic_scale else -ends)
    across /= np.maximum(np.linalg.norm(across, axis=-1, keepdims=True), 1e-9)
    width = lines.width or view.pixel(ends.reshape(-1, 3)).reshape(-1, 2, 1)
    corners = np.stack([ends - across * width / 2, ends + across * width / 2], axis=2)
    end, side = [0, 1, 1, 0, 1, 0], [0, 0, 1, 0, 1, 1]
    tints = np.stack([colors[start], colors[start + 1]], axis=1)[:, end]
    return _triangles(corners[:, end, side].reshape(-1, 3, 3).astype(np.float32), tints.reshape(-1, 3, 4))


# From this number on, small points are drawn as dots, which takes a tenth of the time.
_MANY_POINTS = 20_000
# Maximum diameter of a dot: larger points show their shape [px].
_LARGEST_DOT = 4.0


def _split_points(points: drawables.Points, view: Viewpoint) -> tuple[Dots, drawables.Points]:
    """Return the small points as dots, and the others."""
    centers = view.points(points.points)
    colors = np.broadcast_to(points.colors, (len(centers), 4))
    widths, pixel = _sizes(points, view, centers)[:, 0], view.pixel(centers)[:, 0]
    shade = np.ones(1, np.float32)
    if points.spot in ("box", "tile") and not points.pixels:
        # The projected area of each side, as a fraction of the side's area.
        sight = np.array([[0.0, 0.0, 1.0]]) if view.camera.orthographic_scale else -centers
        seen = (sight @ view.transform_object_to_camera[:3, :3]).astype(np.float32)
        seen /= np.maximum(np.linalg.norm(seen, axis=1, keepdims=True), 1e-9)
        sides = np.abs(seen) * (1 if points.spot == "box" else np.array([0, 0, 1], np.float32))
        area = np.maximum(sides.sum(axis=1), 1e-9)
        widths = widths * np.sqrt(area)
        if points.spot == "box":
            shades = _BOX_SHADES[np.arange(3), (seen < 0).astype(int)]
            shade = (sides * shades).sum(axis=1) / area
    elif points.spot == "sphere":
        # The mean brightness of a disc from its center to its rim.
        shade = np.full(1, 1 - 0.2 * 2 / 3, np.float32)
    is_small = widths <= _LARGEST_DOT * pixel
    colors = colors * np.column_stack([shade, shade, shade, np.ones_like(shade)])
    diameters = np.maximum(widths, pixel)[is_small].astype(np.float32)
    transparent = bool((colors[:, 3] < drawables.OPAQUE_FROM).any())
    is_round = points.spot in ("disc", "sphere")
    dots = Dots(centers[is_small], colors[is_small], diameters, transparent, is_round)
    rest = points.points[~is_small]
    tints = points.colors if points.colors.ndim == 1 else points.colors[~is_small]
    return dots, drawables.Points(rest, tints, points.size, points.pixels, points.spot, points.grow)


def _sizes(points: drawables.Points, view: Viewpoint, centers: Float32s) -> Floats:
    """Return the width, height and depth of each point [m], shape (N, 3)."""
    unit = view.pixel(centers) if points.pixels else np.ones((len(centers), 1))
    sizes: Floats = np.array(points.size) * unit * (points.points[:, 2:] if points.grow else 1)
    return sizes


def _points(points: drawables.Points, view: Viewpoint) -> Triangles:
    centres = view.points(points.points)
    unit, shade = unit_spot(points.spot)
    size = _sizes(points, view, centres)
    # Right, up and ahead of each spot as columns; see RViz's nogp/billboard.vert.
    rotation = view.transform_object_to_camera[:3, :3]
    if points.pixels or points.spot in ("box", "tile"):
        axes = np.broadcast_to(np.eye(3) if points.pixels else rotation, (len(centres), 3, 3))
    else:
        forward = (
            np.broadcast_to([0.0, 0.0, 1.0], centres.shape) if view.camera.orthographic_scale else -centres
        )
        forward = forward / np.linalg.norm(forward, axis=1, keepdims=True)
        right = np.cross(rotation[:, 1], forward)
        right /= np.maximum(np.linalg.norm(right, axis=1, keepdims=True), 1e-9)
        axes = np.stack([right, np.cross(forward, right), forward], axis=-1)
    offsets = np.einsum("nij,tcj,nj->ntci", axes, unit, size)
    corners = (centres[:, None, None] + offsets).reshape(-1, 3, 3).astype(np.float32)
    colors = np.broadcast_to(points.colors, (len(centres), 4))[:, None, None].repeat(len(unit), axis=1)
    colors = (colors * np.concatenate([shade, shade, shade, shade**0], axis=-1)).reshape(-1, 3, 4)
    # Tiles are two-sided, so their back faces are not culled.
    if points.spot != "tile":
        front = _front(corners, view)
        corners, colors = corners[front], colors[front]
    return _triangles(corners, colors)


def _text(text: drawables.Text, view: Viewpoint) -> Triangles:
    glyphs = encoding.rasterize(text.text, text.space_width)
    rows, columns = glyphs.mask.shape
    size = np.array([columns, rows, 0], np.float32) * np.float32(text.height / glyphs.pixels_per_height)
    lowered = SQUARE - np.array([0, 0.5 * text.below, 0], np.float32)
    corners = view.points(np.zeros(3, np.float32)) + lowered * size
    square = _triangles(corners, text.color).corners
    square[..., 7:] = SQUARE[..., :2] + np.float32(0.5)
    return Triangles(square, True, glyphs.mask)


def _sheet(sheet: drawables.Sheet, view: Viewpoint) -> Triangles:
    rows, columns = sheet.cells.shape
    unit = SQUARE + np.array([0.5, 0.5, 0], np.float32)
    size = np.array([columns, rows, 0], np.float32) * np.float32(sheet.width)
    square = _triangles(view.points(unit * size), np.ones(4, np.float32)).corners
    square[..., 7:] = unit[..., :2]
    blended = bool((sheet.colors[..., 3] < drawables.OPAQUE_FROM).any())
    pixels = np.rint(sheet.colors * 255).astype(np.uint8)[sheet.cells[::-1]]
    return Triangles(square, blended, pixels, sheet.is_behind, _ON_SHEETS)


_CONVERTERS: dict[type[drawables.Drawable], Callable[[Any, Viewpoint], Triangles]] = {
    drawables.Solids: _solids,
    drawables.Mesh: _mesh,
    drawables.Lines: _lines,
    drawables.Points: _points,
    drawables.Text: _text,
    drawables.Sheet: _sheet,
}


# Left, top, width, height in [px].
Box: TypeAlias = tuple[int, int, int, int]

# Width of an image and gap between images, as fractions of the view's width.
SHARE, GAP = 0.3, 0.01


def placed_insets(scene: Scene, size: tuple[int, int]) -> Iterator[tuple[drawables.Inset, Box]]:
    """Iterate over the visible insets and their boxes, one below the other at the right edge."""
    objects = scene.objects().items()
    insets = [
        drawable
        for path, drawable in sorted(objects)
        if isinstance(drawable, drawables.Inset) and scene.is_visible(path)
    ]
    width, gap = SHARE * size[0], GAP * size[0]
    needed_height = sum(width / inset.aspect for inset in insets)
    shrink = min(1.0, (size[1] - gap * (len(insets) + 1)) / needed_height) if needed_height else 1.0
    left, top = size[0] - gap - width * shrink, gap
    for inset in insets:
        height = width / inset.aspect * shrink
        yield inset, (round(left), round(top), max(round(width * shrink), 1), max(round(height), 1))
        top += height + gap


# The number of samples that are processed in one step.
_AT_ONCE = 500_000


class CoveredSamples(NamedTuple):
    """Samples inside triangles."""

    # Indices of samples in the image, row by row, shape (N,).
    sample: Indices
    # Indices of the triangles, shape (N,).
    triangle: Indices
    # Barycentric coordinates of the sample, shape (N, 3).
    share: Floats


def covered_samples(xy: Floats, size: tuple[int, int]) -> Iterator[CoveredSamples]:
    """Iterate over the samples whose centers are inside triangles.

    Args:
        xy: Corners in samples, x right and y down, shape (T, 3, 2).
        size: Width and height of the image in samples.
    """
    width, height = size
    low = np.ceil(xy[..., 1].min(axis=1) - 0.5).clip(0, height).astype(int)
    high = np.ceil(xy[..., 1].max(axis=1) - 0.5).clip(0, height).astype(int)
    triangle, y = _expand_ranges(low, high)
    # The barycentric coordinate of each corner is slope * x + start + rise_in_y * y.
    second, third = np.roll(xy, -1, axis=1), np.roll(xy, -2, axis=1)
    rise, run = second[..., 1] - third[..., 1], third[..., 0] - second[..., 0]
    area = rise * (xy[..., 0] - third[..., 0]) + run * (xy[..., 1] - third[..., 1])
    # The comparison also selects NaN.
    flat = ~(np.abs(area) > 1e-9)
    area[flat] = 1
    slope = np.where(flat, 0, rise / area)[triangle]
    # The coordinate of a flat triangle is negative everywhere.
    start = np.where(flat, -1, -(rise * third[..., 0] + run * third[..., 1]) / area)
    rise_in_y = np.where(flat, 0, run / area)
    offset = start[triangle] + rise_in_y[triangle] * (y[:, None] + 0.5)
    # A barycentric coordinate is positive on one side of the edge on which it is zero.
    crossing = -offset / np.where(slope == 0, 1, slope)
    first = np.where(slope > 0, crossing, -np.inf).max(axis=1)
    last = np.where(slope < 0, crossing, np.inf).min(axis=1)
    outside = ((slope == 0) & (offset < 0)).any(axis=1)
    left = np.ceil(first - 0.5).clip(0, width)
    right = np.where(outside, 0, np.ceil(last - 0.5).clip(0, width))
    ends = np.cumsum(np.maximum(right - left, 0))
    for chunk in np.split(
        np.arange(len(y)), np.searchsorted(ends, np.arange(_AT_ONCE, ends[-1:].sum(), _AT_ONCE))
    ):
        row, x = _expand_ranges(left[chunk].astype(int), right[chunk].astype(int))
        row = chunk[row]
        share = slope[row] * (x[:, None] + 0.5) + offset[row]
        yield CoveredSamples(y[row] * width + x, triangle[row], share)


def clip_triangles(corners: Float32s, near: float) -> Float32s:
    """Clip triangles at a distance from the camera; corners of shape (T, 3, K) begin with x, y, z."""
    inside = -corners[..., 2] >= near
    count = inside.sum(axis=1)
    pieces = [corners[count == 3]]
    for inner, build in ((1, ("A", "AB", "AC")), (2, ("AB", "B", "C", "AB", "C", "AC"))):
        crossing, inside_of_some = corners[count == inner], inside[count == inner]
        # The index of the only corner on its side.
        odd = np.argmax(inside_of_some == (inner == 1), axis=1)
        a, b, c = (crossing[np.arange(len(crossing)), (odd + turn) % 3] for turn in range(3))
        points = {"A": a, "B": b, "C": c, "AB": _cut(a, b, near), "AC": _cut(a, c, near)}
        built = np.stack([points[name] for name in build], axis=1)
        pieces.append(built.reshape(-1, 3, corners.shape[2]))
    return np.concatenate(pieces)


def _cut(a: Float32s, b: Float32s, near: float) -> Float32s:
    """Return the intersections of edges with the near plane, shape (N, K)."""
    part: Float32s = (-near - a[:, 2:3]) / (b[:, 2:3] - a[:, 2:3])
    return a + part * (b - a)


def _expand_ranges(start: Indices, stop: Indices) -> tuple[Indices, Indices]:
    """Return the integers of many ranges, preceded by the index of their range."""
    count = np.maximum(stop - start, 0)
    source = np.repeat(np.arange(len(start)), count)
    within = np.arange(len(source)) - np.repeat(np.cumsum(count) - count, count)
    return source, start[source] + within


# Samples per pixel along each axis.
_FINER = 2


@dataclass(frozen=True)
class Fragments:
    """Samples of triangles: index of the sample, distance [m], RGBA, all of length N."""

    sample: Indices
    depth: Float32s
    color: Float32s


def draw(scene: Scene, size: tuple[int, int]) -> bytes:
    """Draw a scene with its insets, and return a PNG; the size is in pixels."""
    # A triangle with NaN covers no pixel.
    with np.errstate(all="ignore"):
        pixels = _pixels(scene, scene.camera, size)
        for inset, (left, top, width, height) in placed_insets(scene, size):
            pixels[top : top + height, left : left + width] = _inset(scene, inset, (width, height))
    png = BytesIO()
    Image.fromarray(pixels).save(png, "png")
    return png.getvalue()


def _inset(scene: Scene, inset: drawables.Inset, size: tuple[int, int]) -> Pixels:
    """Draw an inset, including the scene if it has a camera."""
    image = Image.fromarray(inset.pixels)
    if inset.camera is None:
        return np.asarray(image.resize(size))
    left, top, width, height = inset.area
    coverage = np.ones((size[1], size[0], 1))
    if inset.area == (0.0, 0.0, 1.0, 1.0):
        image = image.resize(size)
    elif min(width, height) > 0:
        # The part of the image that the picture shows; it may be larger than the image.
        box = (-left / width, -top / height, (1 - left) / width, (1 - top) / height)
        extent = tuple(share * side for share, side in zip(box, image.size * 2, strict=True))
        mask = Image.new("L", image.size, 255).transform(size, Image.Transform.EXTENT, extent)
        image = image.transform(size, Image.Transform.EXTENT, extent)
        coverage = np.asarray(mask)[..., None] / 255
    else:
        image, coverage = image.resize(size), 0 * coverage
    picture = np.asarray(image)
    background = np.where(coverage > 0, picture, np.array(scene.background, np.uint8))
    inset_pixels = _pixels(
        scene, inset.camera, size, background if inset.is_behind else None, inset.hidden_paths
    )
    over = inset.overlay_alpha * coverage
    mixed: Pixels = np.rint(inset_pixels * (1 - over) + picture * over).astype(np.uint8)
    return mixed


def _pixels(
    scene: Scene,
    camera: drawables.Camera,
    size: tuple[int, int],
    behind: Pixels | None = None,
    hidden_paths: tuple[str, ...] = (),
) -> Pixels:
    """Draw all objects in RViz's order, like the page.

    The order is: objects behind everything, opaque objects by depth, transparent objects from far
    to near. Lines and points are triangles here, and are handled like surfaces.
    """
    width, height = size[0] * _FINER, size[1] * _FINER
    depths = np.full(width * height, np.inf, np.float32)
    if behind is None:
        behind = np.broadcast_to(np.array(scene.background, np.uint8), (size[1], size[0], 3))
    fine_behind = behind.repeat(_FINER, axis=0).repeat(_FINER, axis=1)
    colors = fine_behind.reshape(-1, 3).astype(np.float32) / np.float32(255)
    seen_through: list[Fragments] = []
    for triangles in triangles_of(scene, camera, size[1], hidden_paths):
        for fragments in _fragments(triangles, camera, (width, height)):
            if triangles.is_behind:
                _blend(depths, colors, [fragments])
            elif triangles.is_transparent:
                seen_through.append(fragments)
            else:
                visible = np.flatnonzero(fragments.depth < depths[fragments.sample])
                # Of each sample, the last fragment written is kept, which is the nearest one.
                order = visible[np.argsort(-fragments.depth[visible], kind="stable")]
                sample = fragments.sample[order]
                depths[sample] = fragments.depth[order]
                colors[sample] = fragments.color[order, :3]
    _blend(depths, colors, seen_through)
    fine_colors = colors.reshape(size[1], _FINER, size[0], _FINER, 3)
    pixels: Pixels = np.rint(fine_colors.mean(axis=(1, 3)) * 255).astype(np.uint8)
    return pixels


def _blend(depths: Float32s, colors: Float32s, parts: list[Fragments]) -> None:
    """Blend fragments over the image, back to front."""
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
    by_layer = np.argsort(layer, kind="stable")
    for now in np.split(by_layer, np.flatnonzero(np.diff(layer[by_layer])) + 1):
        alpha = color[now, 3:]
        colors[sample[now]] = colors[sample[now]] * (1 - alpha) + color[now, :3] * alpha


def _fragments(
    triangles: Triangles | Dots, camera: drawables.Camera, size: tuple[int, int]
) -> Iterator[Fragments]:
    """Iterate over the samples that triangles or dots cover, a limited number at a time."""
    if isinstance(triangles, Dots):
        yield from _dot_fragments(triangles, camera, size)
        return
    perspective = camera.orthographic_scale is None
    corners = clip_triangles(triangles.corners, camera.near) if perspective else triangles.corners
    depth = -corners[..., 2:3]
    scale = camera.pixels_per_metre(depth, size[1]) * (1 if perspective else _FINER)
    middle = np.array(size) / 2 + np.array(camera.shift) * size[1]
    xy = middle + corners[..., :2] * scale * [1, -1]
    weight = 1 / depth if perspective else np.ones_like(depth)
    values = np.concatenate([depth, corners[..., 3:]], axis=-1) * weight
    for spans in covered_samples(xy, size):
        share = spans.share.astype(np.float32)[:, None]
        total = (share @ weight[spans.triangle])[:, 0]
        value = (share @ values[spans.triangle])[:, 0] / total
        value[:, 0] *= 1 + triangles.farther
        sample, color, place = spans.sample, value[:, 1:5], value[:, 5:]
        if (mask := triangles.mask) is not None:
            # The mask multiplies the color.
            rows, columns = mask.shape[:2]
            row = ((1 - place[:, 1]) * rows).astype(int).clip(0, rows - 1)
            column = (place[:, 0] * columns).astype(int).clip(0, columns - 1)
            ink = mask[row, column].reshape(len(row), mask.size // (rows * columns))
            color[:, -ink.shape[1] :] *= ink / np.float32(255)
            inked = color[:, 3] > 0.01
            sample, value, color = sample[inked], value[inked], color[inked]
        yield Fragments(sample, value[:, 0], color)


def _dot_fragments(dots: Dots, camera: drawables.Camera, size: tuple[int, int]) -> Iterator[Fragments]:
    """Iterate over the samples that dots cover, a limited number of dots at a time."""
    depths = -dots.centers[:, 2]
    is_seen = (depths >= camera.near) & (depths <= camera.far)
    middle = np.array(size) / 2 + np.array(camera.shift) * size[1]
    for chunk in np.array_split(np.flatnonzero(is_seen), len(depths) // (_AT_ONCE // 16) + 1):
        depth = depths[chunk]
        scale = camera.pixels_per_metre(depth, size[1])
        scale = scale * (_FINER if camera.orthographic_scale else 1)
        x, y = middle[:, None] + dots.centers[chunk, :2].T * scale * np.array([[1], [-1]])
        half = dots.diameters[chunk] * scale / 2
        left, right, top, bottom = (
            np.ceil(edge - 0.5).clip(0, most).astype(int)
            for edge, most in zip((x - half, x + half, y - half, y + half), np.repeat(size, 2), strict=True)
        )
        dot, index = _expand_ranges(np.zeros(len(chunk), int), (right - left) * (bottom - top))
        row, column = np.divmod(index, (right - left)[dot])
        row, column = row + top[dot], column + left[dot]
        if dots.is_round:
            offsets = np.hypot(column + 0.5 - x[dot], row + 0.5 - y[dot])
            is_inside = offsets <= half[dot]
            dot, row, column = dot[is_inside], row[is_inside], column[is_inside]
        yield Fragments(row * size[0] + column, depth[dot], dots.colors[chunk[dot]])


# First Debian's Chromium without windows: a picture takes 1.3 s of processor time instead of 3.6 s.
_NAMES = (
    "chromium-headless-shell", "chromium", "chromium-browser", "google-chrome", "google-chrome-stable",
    "chrome", "msedge",
)  # fmt: skip
_PLACES = (
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    r"C:\Program Files\Google\Chrome\Application\chrome.exe",
    r"C:\Program Files (x86)\Microsoft\Edge\Application\msedge.exe",
)

# Machines without a screen have only software GL. Updates and reports are disabled.
FLAGS = [
    "--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--disable-gpu-compositing", "--disable-gpu-rasterization",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-extensions", "--no-first-run", "--disable-dev-shm-usage",
]  # fmt: skip


@cache
def find_browser() -> str | None:
    """Return the path of a browser, or None."""
    programs = [shutil.which(name) for name in _NAMES] + [place for place in _PLACES if Path(place).exists()]
    return next((program for program in programs if program), None)


def dump_dom(program: str, page: str, timeout: float) -> str:
    """Load a page, let its scripts run, and return the resulting DOM as text.

    Args:
        program: See `find_browser`.
        page: The text of the page; its scripts must finish while it loads.
        timeout: The timeout [s].

    Raises:
        TimeoutError: The browser took longer and was killed.
        OSError: It cannot be started.
    """
    with tempfile.TemporaryDirectory(prefix="course-", ignore_cleanup_errors=True) as folder:
        path = Path(folder, "scene.html")
        path.write_text(page, encoding="utf-8")
        command = [
            *(program, *FLAGS, f"--user-data-dir={folder}/profile"),
            # Chromium asks Google for updates and for its time, although these are disabled.
            "--host-resolver-rules=MAP * ~NOTFOUND",
            *("--dump-dom", path.as_uri()),
        ]
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        try:
            return process.communicate(timeout=timeout)[0].decode("utf-8", "replace")
        except subprocess.TimeoutExpired:
            raise TimeoutError(f"{program} did not finish within {timeout:g} s.") from None
        finally:
            # Kill the browser with all its helper processes.
            if os.name == "posix":
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)
            else:
                process.kill()
            process.wait()


Renderer: TypeAlias = Literal["page", "chromium", "numpy"]

_TIMEOUT = 60.0  # [s]

# Nothing in this page is asynchronous, so it is complete when it has loaded.
_PAGE = """\
<!doctype html><meta charset="utf-8"><meta http-equiv="Content-Security-Policy" content="%(policy)s">
<body><script>%(script)s</script><script>%(start)s</script>"""
_START = 'document.body.dataset.picture = globalThis["%(key)s"].picture("%(scene)s", %(width)d, %(height)d);'


@dataclass(frozen=True)
class Picture:
    """An image of a scene."""

    # Content of the file.
    png: bytes
    # The program that rendered the picture.
    renderer: Renderer
    # Reason for not using a browser, or "".
    note: str = ""

    def save(self, path: str | Path) -> None:
        """Write the file, and create its folder.

        Raises:
            CourseError: The file cannot be written.
        """
        save_as(path, self.png, "the picture")

    def _repr_png_(self) -> bytes:
        """Return the PNG, to display it below a notebook cell."""
        return self.png

    def __repr__(self) -> str:
        # The width and height follow the signature and the head of a PNG file's first chunk.
        width, height = struct.unpack_from(">II", self.png, 16)
        note = f" ({self.note})" if self.note else ""
        return f"<Picture of {width} x {height} pixels, drawn by {self.renderer}{note}>"


def screenshot(
    scene: Scene,
    path: str | Path | None = None,
    size: tuple[int, int] = (800, 600),
    renderer: Literal["auto", "chromium", "numpy"] = "auto",
) -> Picture:
    """Render the current state of a scene as a PNG with a size in pixels.

    "auto" uses Chromium or Chrome if available, and numpy if there is none or if it fails.

    Raises:
        CourseError: "chromium" was requested and failed.
    """
    if renderer == "numpy":
        picture = Picture(draw(scene, size), "numpy")
    else:
        try:
            picture = Picture(_draw_in_browser(scene, size), "chromium")
        # TimeoutError is an OSError.
        except (CourseError, OSError) as error:
            if renderer == "chromium":
                raise CourseError(f"{error} Use renderer='numpy', which needs no browser.") from error
            picture = Picture(draw(scene, size), "numpy", note=str(error))
    if path is not None:
        picture.save(path)
    return picture


def _draw_in_browser(scene: Scene, size: tuple[int, int]) -> bytes:
    program = find_browser()
    if program is None:
        raise CourseError("No Chromium or Chrome was found on this machine.")
    bundle = html.bundle()
    script = bundle.script.replace("</script", r"<\\/script")
    encoded_scene = base64.b64encode(encoding.encode_snapshot(scene)).decode()
    start = _START % {"key": bundle.name, "scene": encoded_scene, "width": size[0], "height": size[1]}
    page = _PAGE % {"policy": html.content_policy(script, start), "script": script, "start": start}
    match = re.search(r'data-picture="data:image/png;base64,([^"]+)"', dump_dom(program, page, _TIMEOUT))
    if match is None:
        raise CourseError(f"{program} returned no image: is WebGL disabled?")
    return base64.b64decode(match[1])
