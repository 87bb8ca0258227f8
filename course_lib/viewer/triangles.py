"""Everything a scene can hold as triangles that a camera sees, coloured as RViz's light colours them."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from course_lib.arrays import Bools, Bytes, Float32s, Matrix
from course_lib.viewer.camera import Camera
from course_lib.viewer.drawables import (
    OPAQUE_FROM,
    Drawable,
    Lines,
    Mesh,
    Points,
    Shape,
    Sheet,
    Solids,
    Spot,
    Text,
)
from course_lib.viewer.scene import Scene
from course_lib.viewer.text import rasterized

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
    corners = _quads(_revolved(profile[:-1], angles), _revolved(profile[1:], angles))
    if shape == "sphere":
        return Surface(corners, corners)
    if shape == "box":
        flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        return Surface(corners, flat[:, None].repeat(3, axis=1))
    outward = _revolved(np.diff(profile, axis=0)[:, ::-1] * [1, -1], angles)
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


def _revolved(profile: Matrix, angles: Matrix) -> Float32s:
    """Turn points (radius, height), shape (S, 2), around z; returns shape (A, S, 3)."""
    radius, height = profile.T
    x, y = np.outer(np.cos(angles), radius), np.outer(np.sin(angles), radius)
    return np.stack([x, y, np.broadcast_to(height, x.shape)], axis=-1).astype(np.float32)


def _quads(low: Float32s, high: Float32s) -> Float32s:
    """Join what was turned, at the lower and upper ends of segments, to triangles, shape (T, 3, 3)."""
    corners = [low[:-1], low[1:], high[1:], low[:-1], high[1:], high[:-1]]
    return np.stack(corners, axis=2).reshape(-1, 3, 3)


_ON_SHEETS = 1e-3  # like RViz's depth bias of 16 units some 10 m away


@dataclass(frozen=True)
class Triangles:
    """One object as the camera sees it."""

    # x right, y up, -z ahead of the camera, in [m], then RGBA, then the place in the mask, x right and y
    # up in 0..1; shape (T, 3, 9)
    corners: Float32s
    transparent: bool  # whether what is behind shines through
    # how much of the colour there is, 0..255, the first row at the top: of its alpha, shape (rows, columns),
    # or of each part, shape (rows, columns, 4)
    mask: Bytes | None = None
    behind: bool = False  # whether it is behind everything that comes later
    farther: float = 0.0  # share of its distance by which it counts as farther away


@dataclass(frozen=True)
class Viewpoint:
    """The transform from an object to the camera, and the size of a pixel there."""

    transform_object_to_camera: Matrix
    camera: Camera
    height: int

    def points(self, points: Float32s) -> Float32s:
        """Return points, shape (..., 3), as the camera sees them."""
        transform = self.transform_object_to_camera
        return (points @ transform[:3, :3].T + transform[:3, 3]).astype(np.float32)

    def pixel(self, points: Float32s) -> Float32s:
        """Return the size of a pixel in [m] at points that the camera sees, shape (N, 1)."""
        depth = np.maximum(-points[:, 2:], self.camera.near)
        return (1 / self.camera.pixels_per_metre(depth, self.height)).astype(np.float32)


def triangles_of(
    scene: Scene, camera: Camera, height: int, hidden: tuple[str, ...] = ()
) -> Iterator[Triangles]:
    """Iterate over what is to be seen in a picture of some height in pixels, but for some paths.

    What only three.js can draw is left out.
    """
    transform_scene_to_camera = camera.view_matrix()
    without = tuple(f"{path}/" for path in hidden)
    things = scene.objects().items()
    for path, thing in sorted(things, key=lambda item: not getattr(item[1], "behind", False)):
        if type(thing) in _SEEN and scene.visible(path) and not f"{path}/".startswith(without):
            transform = transform_scene_to_camera @ scene.world_transform(path)
            seen = _SEEN[type(thing)](thing, Viewpoint(transform, camera, height))
            near = (-seen.corners[..., 2]).min(axis=1, initial=np.inf) <= camera.far
            yield seen if near.all() else replace(seen, corners=seen.corners[near])


def _triangles(points: Float32s, colors: Float32s, lit_by: Float32s | None = None) -> Triangles:
    """Join corners, shape (T, 3, 3), with their colours, shape (T, 3, 4), darkened by normals."""
    colors = np.broadcast_to(colors, (*points.shape[:2], 4)).astype(np.float32)
    if lit_by is not None:
        length = np.linalg.norm(lit_by, axis=-1, keepdims=True)
        colors[..., :3] *= np.abs(lit_by[..., 2:]) / np.maximum(length, 1e-12)
    corners = np.concatenate([points, colors, np.zeros((*points.shape[:2], 2), np.float32)], axis=-1)
    return Triangles(corners, bool((colors[..., 3] < OPAQUE_FROM).any()))


def _normals(corners: Float32s) -> Float32s:
    """Return the normal of each triangle, shape (T, 1, 3), of any length."""
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, None]


def _turned(normals: Float32s, transform: Matrix) -> Float32s:
    """Return normals, shape (..., 3), after a transform, shape (..., 4, 4), that may stretch or flatten."""
    x, y, z = (transform[..., :3, axis] for axis in range(3))
    cofactors = np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=-1)
    return (cofactors @ normals[..., None])[..., 0].astype(np.float32)


def _solids(solids: Solids, view: Viewpoint) -> Triangles:
    unit = unit_shape(solids.shape, 32 if len(solids.placements) < 50 else 12)
    placements = (view.transform_object_to_camera @ solids.placements)[:, None, None]
    points = (placements[..., :3, :3] @ unit.corners[..., None])[..., 0] + placements[..., :3, 3]
    corners = points.reshape(-1, 3, 3).astype(np.float32)
    normals = _turned(unit.normals, placements).reshape(-1, 3, 3)
    each = np.broadcast_to(solids.colors, (len(points), 4))
    colors = np.repeat(each, len(unit.corners), axis=0)[:, None]
    front = _front(corners, view)
    return _triangles(corners[front], colors[front], normals[front] if solids.lit else None)


def _front(corners: Float32s, view: Viewpoint) -> Bools:
    """Return the triangles that turn their front to the camera."""
    towards = [0, 0, 1] if view.camera.orthographic_scale else -corners[:, 0]
    front: Bools = (_normals(corners)[:, 0] * towards).sum(axis=-1) > 0
    return front


def _mesh(mesh: Mesh, view: Viewpoint) -> Triangles:
    points = view.points(mesh.vertices)[mesh.faces]
    colors = np.broadcast_to(mesh.colors, (len(mesh.vertices), 4))[mesh.faces]
    if not mesh.lit:
        return _triangles(points, colors)
    if mesh.normals is None:
        return _triangles(points, colors, _normals(points))
    return _triangles(points, colors, _turned(mesh.normals, view.transform_object_to_camera)[mesh.faces])


def _lines(lines: Lines, view: Viewpoint) -> Triangles:
    """Widen each segment across the line that joins its neighbours, as Ogre's billboard chain does."""
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


def _points(points: Points, view: Viewpoint) -> Triangles:
    centres = view.points(points.points)
    unit, shade = unit_spot(points.spot)
    size = np.array(points.size) * (view.pixel(centres) if points.pixels else np.ones((len(centres), 1)))
    size = size * (points.points[:, 2:] if points.grow else 1)
    offsets = np.einsum("nij,tcj,nj->ntci", _spot_axes(points, centres, view), unit, size)
    corners = (centres[:, None, None] + offsets).reshape(-1, 3, 3).astype(np.float32)
    colors = np.broadcast_to(points.colors, (len(centres), 4))[:, None, None].repeat(len(unit), axis=1)
    colors = (colors * np.concatenate([shade, shade, shade, shade**0], axis=-1)).reshape(-1, 3, 4)
    if points.spot != "tile":  # which has two sides
        front = _front(corners, view)
        corners, colors = corners[front], colors[front]
    return _triangles(corners, colors)


def _spot_axes(points: Points, centres: Float32s, view: Viewpoint) -> Matrix:
    """Return right, up and ahead of each spot as columns, shape (N, 3, 3); see RViz's nogp/billboard.vert."""
    rotation = view.transform_object_to_camera[:3, :3]
    if points.pixels or points.spot in ("box", "tile"):
        return np.broadcast_to(np.eye(3) if points.pixels else rotation, (len(centres), 3, 3))
    towards = np.broadcast_to([0.0, 0.0, 1.0], centres.shape) if view.camera.orthographic_scale else -centres
    towards = towards / np.linalg.norm(towards, axis=1, keepdims=True)
    right = np.cross(rotation[:, 1], towards)
    right /= np.maximum(np.linalg.norm(right, axis=1, keepdims=True), 1e-9)
    return np.stack([right, np.cross(towards, right), towards], axis=-1)


def _text(text: Text, view: Viewpoint) -> Triangles:
    glyphs = rasterized(text.text)
    rows, columns = glyphs.mask.shape
    size = np.array([columns, rows, 0], np.float32) * np.float32(text.height / glyphs.pixels_per_height)
    lowered = SQUARE - np.array([0, 0.5 * text.below, 0], np.float32)
    corners = view.points(np.zeros(3, np.float32)) + lowered * size
    square = _triangles(corners, text.color).corners
    square[..., 7:] = SQUARE[..., :2] + np.float32(0.5)
    return Triangles(square, True, glyphs.mask)


def _sheet(sheet: Sheet, view: Viewpoint) -> Triangles:
    rows, columns = sheet.cells.shape
    unit = SQUARE + np.array([0.5, 0.5, 0], np.float32)
    size = np.array([columns, rows, 0], np.float32) * np.float32(sheet.width)
    square = _triangles(view.points(unit * size), np.ones(4, np.float32)).corners
    square[..., 7:] = unit[..., :2]
    blended = bool((sheet.colors[..., 3] < OPAQUE_FROM).any())
    pixels = np.rint(sheet.colors * 255).astype(np.uint8)[sheet.cells[::-1]]
    return Triangles(square, blended, pixels, sheet.behind, _ON_SHEETS)


_SEEN: dict[type[Drawable], Callable[[Any, Viewpoint], Triangles]] = {
    Solids: _solids,
    Mesh: _mesh,
    Lines: _lines,
    Points: _points,
    Text: _text,
    Sheet: _sheet,
}
