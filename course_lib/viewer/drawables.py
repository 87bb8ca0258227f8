"""Everything that a scene can hold, as plain arrays: checked, converted and frozen when it is made."""

from collections.abc import Mapping
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from course_lib.arrays import Bytes, Float32s, UInt32s
from course_lib.errors import CourseError
from course_lib.viewer.camera import Camera


class ShapeError(CourseError):
    """An array does not have the shape that its name asks for."""


def checked(name: str, value: npt.ArrayLike, dtype: npt.DTypeLike, *shapes: tuple[int | None, ...]) -> Any:
    """Return a read-only copy of an array that has one of the shapes (None stands for any length).

    Raises:
        ShapeError: If it has none of them; the message shows both shapes.
    """
    array = np.array(value, dtype=dtype)
    if array.size == 0 and not shapes[0][0]:  # [] is an empty list of anything
        array = array.reshape(tuple(length or 0 for length in shapes[0]))
    if array.shape not in shapes and not any(_fits(array.shape, shape) for shape in shapes):
        wanted = " or ".join(_shape_text(shape) for shape in shapes)
        raise ShapeError(f"{name} has shape {_shape_text(array.shape)}, expected {wanted}.")
    array.setflags(write=False)
    return array


def floats(name: str, value: npt.ArrayLike, *shapes: tuple[int | None, ...]) -> Float32s:
    """Check an array and keep it in single precision, as it is drawn."""
    array: Float32s = checked(name, value, np.float32, *shapes)
    return array


def rgba(value: npt.ArrayLike, count: int | None = None) -> Float32s:
    """Check RGBA, shape (4,), or also (count, 4), and keep it within 0..1; NaN becomes 0."""
    shapes = ((4,),) if count is None else ((count, 4), (4,))
    checked_rgba: Float32s = np.nan_to_num(floats("colors", value, *shapes)).clip(0, 1)
    checked_rgba.setflags(write=False)
    return checked_rgba


def _fits(shape: tuple[int, ...], wanted: tuple[int | None, ...]) -> bool:
    return len(shape) == len(wanted) and all(w in (None, n) for n, w in zip(shape, wanted, strict=True))


def _shape_text(shape: tuple[int | None, ...]) -> str:
    return f"({', '.join('N' if length is None else str(length) for length in shape)})"


Shape: TypeAlias = Literal["box", "sphere", "cylinder", "cone"]
Spot: TypeAlias = Literal["square", "disc", "sphere", "box", "tile"]

OPAQUE_FROM = 0.9998  # below this alpha RViz blends, and writes no depth


class Solids:
    """Many copies of one unit shape.

    Args:
        shape: Unit box, sphere of diameter 1, or cylinder or cone of diameter 1 and height 1 along z; all
            are centred on their origin, the tip of the cone points to +z.
        placements: Affine transforms from the unit shape to the node, shape (N, 4, 4), [m].
        colors: RGBA, 0 to 1, shape (N, 4), or (4,) for all of them.
        lit: Whether faces are shaded.
    """

    def __init__(self, shape: Shape, placements: ArrayLike, colors: ArrayLike, lit: bool = True) -> None:
        if shape not in get_args(Shape):
            raise CourseError(f"Solids(shape={shape!r}): take one of {', '.join(get_args(Shape))}.")
        self.shape: Shape = shape
        self.placements = floats("placements", placements, (None, 4, 4))
        self.colors = rgba(colors, len(self.placements))
        self.lit = lit


class Mesh:
    """Triangles, seen from both sides.

    Args:
        vertices: Shape (V, 3), [m].
        faces: Corners of each triangle by index, shape (F, 3); None if each three vertices make one.
        colors: RGBA, 0 to 1, shape (V, 4), or (4,) for all of them.
        normals: Unit normals at the vertices, shape (V, 3); None gives each triangle its own.
        lit: Whether faces are shaded.
    """

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike | None,
        colors: ArrayLike,
        normals: ArrayLike | None = None,
        lit: bool = True,
    ) -> None:
        self.vertices = floats("vertices", vertices, (None, 3))
        count = len(self.vertices)
        self.faces = _faces(faces, count)
        self.colors = rgba(colors, count)
        self.normals = None if normals is None else floats("normals", normals, (count, 3))
        self.lit = lit


class Lines:
    """Strips that turn their flat side to the camera, as RViz's billboard lines do.

    Args:
        points: Shape (P, 3), [m]; joined one after the other, or, if not ``strip``, in pairs.
        colors: RGBA, 0 to 1, shape (P, 4), or (4,) for all of them.
        width: Width of the strip, [m]; 0 draws a line that is one pixel wide.
        strip: Whether each point is joined to the next.
    """

    def __init__(self, points: ArrayLike, colors: ArrayLike, width: float = 0.0, strip: bool = True) -> None:
        self.points = floats("points", points, (None, 3))
        if not strip and len(self.points) % 2:
            raise CourseError(f"Lines in pairs need an even number of points, there are {len(self.points)}.")
        self.colors = rgba(colors, len(self.points))
        self.width = float(width)
        self.strip = strip


class Points:
    """Spots as RViz's point clouds have them: flat and turned to the camera, or along the node's axes.

    Args:
        points: Shape (P, 3), [m].
        colors: RGBA, 0 to 1, shape (P, 4), or (4,) for all of them.
        size: Width and height, for boxes also depth, in [m], or in pixels.
        pixels: Whether the size is in pixels.
        spot: What is drawn at each point; RViz's spheres are discs, darker at the rim; boxes
            keep the node's axes, tiles lie in its xy plane.
        grow: Whether the size is that at z = 1 m, and in proportion elsewhere.
    """

    def __init__(
        self,
        points: ArrayLike,
        colors: ArrayLike,
        size: tuple[float, ...],
        pixels: bool = False,
        spot: Spot = "square",
        grow: bool = False,
    ) -> None:
        self.points = floats("points", points, (None, 3))
        self.colors = rgba(colors, len(self.points))
        self.size = (*map(float, size), 0.0)[:3]
        self.pixels = pixels
        self.spot = spot
        self.grow = grow


class Text:
    """Words that face the camera, at the origin of their node.

    Args:
        text: May have several lines.
        height: Height of a capital letter, [m].
        color: RGBA, 0 to 1, shape (4,).
        below: Whether all of it is below the origin in the picture; else it is centred there.
    """

    def __init__(
        self, text: str, height: float, color: ArrayLike = (1.0, 1.0, 1.0, 1.0), below: bool = False
    ) -> None:
        self.text = text
        self.height = float(height)
        self.color = rgba(color)
        self.below = below


class Sheet:
    """Cells in the xy plane of its node, the first one at the origin; nothing shades them.

    What lies in the same plane is seen on it.

    Args:
        cells: Numbers of their colours, shape (rows, columns); rows go along y.
        colors: Shape (256, 4).
        width: Of a cell in [m].
        behind: Whether it is behind everything, wherever it is.
    """

    def __init__(self, cells: ArrayLike, colors: ArrayLike, width: float, behind: bool = False) -> None:
        self.cells: Bytes = checked("cells", cells, np.uint8, (None, None))
        self.colors = rgba(colors, 256)
        self.width = float(width)
        self.behind = behind


class Inset:
    """A picture in a corner of the view, in front of everything, wherever its node is.

    Args:
        pixels: RGB, 0..255, shape (rows, columns, 3).
        aspect: Width of what is shown through its height.
        camera: Draws the scene from there over the picture; None shows the picture alone.
        behind: Whether the picture is behind the scene; else the scene's background is.
        over: How much of the picture covers the scene, 0..1.
        hidden: Paths of nodes that this camera does not see.
    """

    def __init__(
        self,
        pixels: ArrayLike,
        aspect: float | None = None,
        camera: Camera | None = None,
        behind: bool = True,
        over: float = 0.0,
        hidden: tuple[str, ...] = (),
    ) -> None:
        self.pixels: Bytes = checked("pixels", pixels, np.uint8, (None, None, 3))
        rows, columns = self.pixels.shape[:2]
        self.aspect = float(aspect or columns / max(rows, 1))
        self.camera = camera
        self.behind = behind
        self.over = float(over)
        self.hidden = hidden


class MeshcatObject:
    """An object that only three.js can draw, as the meshcat package describes it.

    Args:
        json: three.js's JSON of the object, with its geometries and materials.
    """

    def __init__(self, json: Mapping[str, Any]) -> None:
        self.json = json


Drawable: TypeAlias = Solids | Mesh | Lines | Points | Text | Sheet | Inset | MeshcatObject


def _faces(faces: ArrayLike | None, count: int) -> UInt32s:
    """Return the corners of all triangles, shape (F, 3)."""
    if faces is None:
        if count % 3:
            raise CourseError(f"A mesh without faces needs 3 vertices per triangle, there are {count}.")
        faces = np.arange(count).reshape(-1, 3)
    corners: UInt32s = checked("faces", faces, np.uint32, (None, 3))
    if corners.size and corners.max() >= count:
        raise CourseError(f"A face of the mesh names vertex {corners.max()}, the last one is {count - 1}.")
    return corners
