"""Pictures made with numpy alone, where no browser is: triangles, a depth for each pixel, blending."""

from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO

import numpy as np
from PIL import Image

from course_lib.arrays import Bytes, Float32s, Indices, Pixels
from course_lib.viewer.camera import Camera
from course_lib.viewer.drawables import Inset
from course_lib.viewer.insets import placed_insets
from course_lib.viewer.raster import clipped, covered
from course_lib.viewer.scene import Scene
from course_lib.viewer.triangles import Triangles, triangles_of

_FINER = 2  # samples per pixel along each axis


@dataclass(frozen=True)
class Fragments:
    """Samples of triangles: which sample of the picture, how far away [m], RGBA; all of length N."""

    sample: Indices
    depth: Float32s
    color: Float32s


def draw(scene: Scene, size: tuple[int, int]) -> bytes:
    """Draw a scene, with the pictures in its corner, and return the PNG; the size is in pixels."""
    with np.errstate(invalid="ignore", over="ignore"):  # what is no number covers no pixel
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
