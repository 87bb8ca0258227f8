"""The camera, and all objects that a scene can contain, made of validated and immutable arrays.

Meshes from files are converted once to the arrays that are drawn.
"""

import logging
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from io import BytesIO
from math import pi, tan
from pathlib import Path
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
import numpy.typing as npt
from numpy.typing import ArrayLike

from course_lib.arrays import Bytes, Float32s, Floats, Matrix, Reals, UInt32s, Vector
from course_lib.errors import CourseError
from course_lib.third_party import LFS_POINTER, NOT_FETCHED, read_bytes

# Far clipping distance of RViz's views [m].
FAR = 100_000.0


@dataclass(frozen=True)
class Camera:
    """A view of the scene, in the scene's own frame and [m]."""

    # Position.
    eye: Vector = (5.0, 5.0, 7.071068)
    # Focal point, around which it orbits.
    target: Vector = (0.0, 0.0, 0.0)
    # Direction that is up in the image.
    up: Vector = (0.0, 0.0, 1.0)
    # Opening angle [rad]; 45 degrees in RViz.
    vertical_fov: float = pi / 4
    # Near clipping distance.
    near: float = 0.01
    # pixels per metre of a view without perspective; None for perspective
    orthographic_scale: float | None = None
    # offset of the focal point to the right of and below the image center, in image heights
    shift: tuple[float, float] = (0.0, 0.0)
    # Far clipping distance.
    far: float = FAR

    def __post_init__(self) -> None:
        for name in ("eye", "target", "up"):
            value = tuple(float(number) for number in getattr(self, name))
            if len(value) != 3 or not np.isfinite(value).all():
                raise CourseError(
                    f"Camera({name}={value}) is not a point: expected three finite numbers (x, y, z)."
                )
            object.__setattr__(self, name, value)
        if self.eye == self.target:
            raise CourseError(
                f"The camera's eye and target are both {self.eye}, so it has no viewing direction."
            )

    def view_matrix(self) -> Matrix:
        """Return the transform from the scene to the camera (x right, y up, -z ahead), shape (4, 4)."""
        forward = _unit(np.subtract(self.target, self.eye))
        side = np.cross(forward, self.up)
        # If the camera looks along `up`, any perpendicular direction can be up.
        if np.linalg.norm(side) < 1e-6:
            side = np.cross(forward, (0.0, 1.0, 0.0) if abs(forward[1]) < 0.9 else (1.0, 0.0, 0.0))
        right = _unit(side)
        rotation = np.stack([right, np.cross(right, forward), -forward])
        transform_scene_to_camera = np.eye(4)
        transform_scene_to_camera[:3, :3] = rotation
        transform_scene_to_camera[:3, 3] = -rotation @ np.asarray(self.eye)
        return transform_scene_to_camera

    def pixels_per_metre(self, depth: Reals, height: int) -> Reals:
        """Return the pixels per metre at depths in front of the eye, in an image of the given height."""
        if self.orthographic_scale is not None:
            return np.full_like(depth, self.orthographic_scale)
        return 0.5 * height / tan(self.vertical_fov / 2) / depth


def _unit(vector: Floats) -> Floats:
    length: float = np.linalg.norm(vector).item()
    return vector / length


class ShapeError(CourseError):
    """Raised for an array with an unexpected shape."""


def checked_array(
    name: str, value: npt.ArrayLike, dtype: npt.DTypeLike, *shapes: tuple[int | None, ...]
) -> Any:
    """Return a read-only copy of an array of one of the given shapes; None matches any length.

    Raises:
        ShapeError: The array has none of the shapes; the message has both.
    """
    array = np.array(value, dtype=dtype)
    # An empty list is treated as an array of the first shape.
    if array.size == 0 and not shapes[0][0]:
        array = array.reshape(tuple(length or 0 for length in shapes[0]))
    if array.shape not in shapes and not any(
        len(array.shape) == len(shape)
        and all(w in (None, n) for n, w in zip(array.shape, shape, strict=True))
        for shape in shapes
    ):
        expected = " or ".join(_shape_text(shape) for shape in shapes)
        raise ShapeError(f"{name} has shape {_shape_text(array.shape)}, expected {expected}.")
    array.setflags(write=False)
    return array


def float_array(name: str, value: npt.ArrayLike, *shapes: tuple[int | None, ...]) -> Float32s:
    """Check an array, and convert it to single precision."""
    array: Float32s = checked_array(name, value, np.float32, *shapes)
    return array


def rgba(value: npt.ArrayLike, count: int | None = None) -> Float32s:
    """Check RGBA, shape (4,) or with `count` also (count, 4), and clip it to 0..1; NaN becomes 0."""
    shapes = ((4,),) if count is None else ((count, 4), (4,))
    checked_rgba: Float32s = np.nan_to_num(float_array("colors", value, *shapes)).clip(0, 1)
    checked_rgba.setflags(write=False)
    return checked_rgba


def _shape_text(shape: tuple[int | None, ...]) -> str:
    return f"({', '.join('N' if length is None else str(length) for length in shape)})"


Shape: TypeAlias = Literal["box", "sphere", "cylinder", "cone"]
Spot: TypeAlias = Literal["square", "disc", "sphere", "box", "tile"]

# Below this alpha RViz blends, and writes no depth.
OPAQUE_FROM = 0.9998


class Solids:
    """Copies of one unit shape.

    Args:
        shape: Unit box, sphere of diameter 1, or cylinder or cone of diameter 1 and height 1 along
            z; all are centered at their origin, and the tip of the cone points to +z.
        placements: Affine transforms from the unit shape to the node, shape (N, 4, 4), [m].
        colors: RGBA, 0 to 1, shape (N, 4), or (4,) for a single color.
        lit: Whether faces are shaded.
    """

    def __init__(
        self,
        shape: Shape,
        placements: ArrayLike,
        colors: ArrayLike,
        lit: bool = True,
    ) -> None:
        if shape not in get_args(Shape):
            raise CourseError(f"Solids(shape={shape!r}): expected one of {', '.join(get_args(Shape))}.")
        self.shape: Shape = shape
        self.placements = float_array("placements", placements, (None, 4, 4))
        with np.errstate(all="ignore"):
            is_mirrored = np.linalg.det(self.placements[:, :3, :3]) < 0
        if is_mirrored.any():
            # A renderer would show the inner sides of mirrored faces. All shapes are symmetric in
            # x.
            self.placements = self.placements.copy()
            self.placements[is_mirrored, :3, 0] *= -1
            self.placements.setflags(write=False)
        self.colors = rgba(colors, len(self.placements))
        self.lit = lit


class Mesh:
    """Two-sided triangles.

    Args:
        vertices: Shape (V, 3), [m].
        faces: Triangles by index of their vertices, shape (F, 3); None if three consecutive
            vertices form a triangle.
        colors: RGBA, 0 to 1, shape (V, 4), or (4,) for a single color.
        normals: Unit normals at the vertices, shape (V, 3); None uses the normal of each triangle.
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
        self.vertices = float_array("vertices", vertices, (None, 3))
        count = len(self.vertices)
        if faces is None:
            if count % 3:
                raise CourseError(
                    f"A mesh without faces needs 3 vertices per triangle, but there are {count}. "
                    "Pass faces, or all corners of each triangle."
                )
            faces = np.arange(count).reshape(-1, 3)
        corners: UInt32s = checked_array("faces", faces, np.uint32, (None, 3))
        if corners.size and corners.max() >= count:
            raise CourseError(
                f"A face of the mesh has the vertex index {corners.max()}, "
                f"but the last vertex is {count - 1}. Indices are counted from 0."
            )
        self.faces = corners
        self.colors = rgba(colors, count)
        self.normals = None if normals is None else float_array("normals", normals, (count, 3))
        self.lit = lit

    @cached_property
    def corners(self) -> Floats:
        """Lowest and highest corner of the bounding box, shape (2, 3); (0, 3) without vertices."""
        if not len(self.vertices):
            return np.empty((0, 3))
        return np.stack([self.vertices.min(axis=0), self.vertices.max(axis=0)]).astype(float)


class Lines:
    """Flat strips that face the camera, like RViz's billboard lines.

    Args:
        points: Shape (P, 3), [m]; each is joined to the next or, without ``strip``, in pairs.
        colors: RGBA, 0 to 1, shape (P, 4), or (4,) for a single color.
        width: Width of the strip, [m]; 0 draws a line that is one pixel wide.
        strip: Whether each point is joined to the next.
    """

    def __init__(
        self,
        points: ArrayLike,
        colors: ArrayLike,
        width: float = 0.0,
        strip: bool = True,
    ) -> None:
        self.points = float_array("points", points, (None, 3))
        if not strip and len(self.points) % 2:
            raise CourseError(
                f"Lines in pairs need an even number of points, but there are {len(self.points)}. "
                "Pass two points for each line, or strip=True."
            )
        self.colors = rgba(colors, len(self.points))
        self.width = float(width)
        self.strip = strip


class Points:
    """Spots as in RViz's point clouds: flat and facing the camera, or along the node's axes.

    Args:
        points: Shape (P, 3), [m].
        colors: RGBA, 0 to 1, shape (P, 4), or (4,) for a single color.
        size: Width and height (for boxes also depth) in [m] or in pixels.
        pixels: Whether the size is in pixels.
        spot: The shape drawn at each point. RViz's spheres are discs, darker at the rim; boxes keep
            the node's axes, tiles are in its xy plane.
        grow: Whether the size applies at z = 1 m and is proportional to z.
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
        self.points = float_array("points", points, (None, 3))
        self.colors = rgba(colors, len(self.points))
        self.size = (*map(float, size), 0.0)[:3]
        self.pixels = pixels
        self.spot = spot
        self.grow = grow


class Text:
    """Text that faces the camera, at the origin of its node.

    Args:
        text: The text, which may have several lines. They begin at the same position.
        height: Height of a capital letter, [m].
        color: RGBA, 0 to 1, shape (4,).
        below: Whether the text is below the origin in the image, instead of centered at it.
        space_width: Width of a space, [m]; 0 uses that of the font.
    """

    def __init__(
        self,
        text: str,
        height: float,
        color: ArrayLike = (1.0, 1.0, 1.0, 1.0),
        below: bool = False,
        space_width: float = 0.0,
    ) -> None:
        self.text = text
        self.height = float(height)
        self.color = rgba(color)
        self.below = below
        # In heights of a capital letter.
        self.space_width = float(space_width) / self.height if space_width and self.height else 0.0


class Sheet:
    """Cells in the xy plane of a node, the first one at the origin, without shading.

    Other objects in the same plane are drawn over it.

    Args:
        cells: Color indices, shape (rows, columns); rows are along y.
        colors: Shape (256, 4).
        width: Width of a cell [m].
        is_behind: Whether it is drawn behind everything else.
    """

    def __init__(
        self,
        cells: ArrayLike,
        colors: ArrayLike,
        width: float,
        is_behind: bool = False,
    ) -> None:
        self.cells: Bytes = checked_array("cells", cells, np.uint8, (None, None))
        self.colors = rgba(colors, 256)
        self.width = float(width)
        self.is_behind = is_behind


class Inset:
    """An image in a corner of the view, in front of the scene; its node's position is irrelevant.

    Args:
        pixels: RGB, 0..255, shape (rows, columns, 3).
        aspect: Width divided by height of the displayed image.
        camera: The camera that draws the scene over the image; None shows only the image.
        is_behind: Whether the image is behind the scene, instead of the background color.
        overlay_alpha: Opacity of the image over the scene, 0..1.
        hidden_paths: Paths of nodes that this camera does not draw.
        area: Left, top, width and height of the image, as fractions of the displayed picture; used with
            a camera only.
    """

    def __init__(
        self,
        pixels: ArrayLike,
        aspect: float | None = None,
        camera: Camera | None = None,
        is_behind: bool = True,
        overlay_alpha: float = 0.0,
        hidden_paths: tuple[str, ...] = (),
        area: tuple[float, float, float, float] = (0.0, 0.0, 1.0, 1.0),
    ) -> None:
        self.pixels: Bytes = checked_array("pixels", pixels, np.uint8, (None, None, 3))
        rows, columns = self.pixels.shape[:2]
        self.aspect = float(aspect or columns / max(rows, 1))
        self.camera = camera
        self.is_behind = is_behind
        self.overlay_alpha = float(overlay_alpha)
        self.hidden_paths = hidden_paths
        self.area = area


class MeshcatObject:
    """An object that only three.js can draw, in meshcat's description.

    Args:
        json: three.js's JSON of the object, with its geometries and materials.
        stand_in: The drawable that replaces it in pictures; None if none is similar.
    """

    def __init__(self, json: Mapping[str, Any], stand_in: "Mesh | None" = None) -> None:
        self.json = json
        self.stand_in = stand_in


Drawable: TypeAlias = Solids | Mesh | Lines | Points | Text | Sheet | Inset | MeshcatObject


def are_equal(one: Drawable, other: Drawable) -> bool:
    """Return whether two drawables are of one class and have equal arguments.

    NaN is not equal to anything, and an object of meshcat is equal only to itself.
    """
    if one is other or type(one) is not type(other) or isinstance(one, MeshcatObject):
        return one is other
    # Cached properties depend only on the arguments, and may exist in only one of the two.
    arguments, others = vars(one), vars(other)
    return all(
        np.array_equal(value, others[name]) if isinstance(value, np.ndarray) else value == others[name]
        for name, value in arguments.items()
        if name in others
    )


# trimesh logs a traceback for each missing texture, which logging prints if there is no handler.
logging.getLogger("trimesh").addHandler(logging.NullHandler())
# A mesh of trimesh, and the transform from it to the file's frame.
Part: TypeAlias = tuple[Any, Matrix]

FORMATS = ("dae", "stl", "obj", "ply")

_END_OF_DAE = b"</COLLADA>"
_BARE_AMPERSAND = re.compile(rb"&(?!#?\w+;)")
_TAG_IN_ATTRIBUTE = re.compile(rb'="[^"<]*<[^"]*"')
# Material bindings of a DAE file. pycollada drops parts with a broken material, RViz does not.
_PAINT = re.compile(rb"<bind_material>.*?</bind_material>", re.S)
# Color of a file without colors.
_PLAIN = np.array([0.7, 0.7, 0.7, 1.0], np.float32)


class MeshFileError(CourseError):
    """Raised for a mesh file that cannot be read."""


# Vertices, shape (V, 3), texture coordinates, shape (V, 2), and faces, shape (F, 3).
Surface: TypeAlias = tuple[Floats, Floats, Floats]
# About the number of triangles into which a textured surface is divided.
_SMALL_TRIANGLES = 50_000


def subdivide(points: Reals, coordinates: Reals, most_steps: int) -> Surface:
    """Divide triangles into small ones, so that the colors of their vertices show a texture.

    Args:
        points: The corners of each triangle, shape (F, 3, 3).
        coordinates: Their texture coordinates, shape (F, 3, 2).
        most_steps: The limit for the number of steps along each side.
    """
    steps = int(np.clip(np.sqrt(_SMALL_TRIANGLES / max(len(points), 1)), 1, most_steps))
    # The points that subdivide a triangle, as weights of its corners, and the small triangles.
    pairs = [(i, j) for i in range(steps + 1) for j in range(steps + 1 - i)]
    number = {pair: index for index, pair in enumerate(pairs)}
    weights = np.array([(steps - i - j, i, j) for i, j in pairs], float) / steps
    upright = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in pairs if i + j < steps]
    inverted = [
        (number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in pairs if i + j < steps - 1
    ]
    faces = np.array(upright + inverted)
    many = (np.einsum("wc,fcx->fwx", weights, part) for part in (points, coordinates))
    vertices, places = (part.reshape(-1, part.shape[-1]) for part in many)
    starts = np.arange(len(points)) * len(weights)
    return vertices, places, (starts[:, None, None] + faces).reshape(-1, 3)


def load_mesh(path: Path) -> Mesh:
    """Read a DAE, STL, OBJ or PLY file. As in RViz, its unit is applied, but not its up axis.

    Raises:
        MeshFileError: It is not such a file, or is damaged.
    """
    file_format = path.suffix.lstrip(".").lower()
    try:
        # A file of another format may be endless, like a file in /proc.
        _check_format(file_format)
        return parse_mesh(read_bytes(path), file_format, folder=path.parent)
    except (OSError, MeshFileError) as error:
        raise MeshFileError(f"{path}: {error}") from error


@lru_cache(maxsize=128)
def parse_mesh(
    data: bytes,
    file_format: str,
    color: tuple[float, ...] | None = None,
    folder: Path | None = None,
) -> Mesh:
    """Parse the content of a file, see `load_mesh`; textures are read from the folder.

    `color` is a single RGBA color; None uses the file's materials, or gray if it has none.
    """
    # Imported here because it is slow to load.
    from trimesh.units import unit_conversion

    _check_format(file_format)
    if data.startswith(LFS_POINTER):
        raise MeshFileError(f"This is not a {file_format.upper()} file: {NOT_FETCHED}.")
    if file_format == "dae":
        # Exporters leave these faults, which RViz's reader of XML ignores.
        document, end, _ = data.lstrip().partition(_END_OF_DAE)  # zeros or old data follow
        data = _BARE_AMPERSAND.sub(b"&amp;", document + end)
        data = _TAG_IN_ATTRIBUTE.sub(lambda match: match[0].replace(b"<", b"&lt;"), data)
    try:
        scene, parts = _read(data, file_format, folder)
        if not parts and _PAINT.search(data):
            scene, parts = _read(_PAINT.sub(b"", data), file_format, folder)
        unit = unit_conversion(scene.units or "meters", "meters")  # [m]
        if any(len(mesh.faces) for mesh, _ in parts):
            return _merge(parts, unit, color)
    except Exception as error:
        # trimesh's readers can raise any exception for a damaged file, and return arrays of any
        # shape.
        raise MeshFileError(f"This is not a readable {file_format.upper()} file: {error}") from error
    raise MeshFileError(f"This is not a readable {file_format.upper()} file: it has no triangles.")


def _check_format(file_format: str) -> None:
    if file_format not in FORMATS:
        raise MeshFileError(
            f"{file_format!r} is not a supported mesh format; use one of {', '.join(FORMATS)}."
        )


def _merge(parts: list[Part], unit: float, color: tuple[float, ...] | None) -> Mesh:
    meshes = [mesh for mesh, _ in parts]
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    # Normals from the file are in the cache; otherwise trimesh would compute them.
    smooth = all("vertex_normals" in mesh._cache for mesh in meshes)
    normals = []
    for mesh, place in parts if smooth else ():
        # The transform may scale.
        rotated = mesh.vertex_normals @ np.linalg.pinv(place[:3, :3])
        normals.append(rotated / np.maximum(np.linalg.norm(rotated, axis=1, keepdims=True), 1e-12))
    return Mesh(
        np.concatenate([mesh.vertices @ place[:3, :3].T + place[:3, 3] for mesh, place in parts]) * unit,
        np.concatenate([mesh.faces + start for mesh, start in zip(meshes, starts, strict=True)]),
        np.concatenate([_colors(mesh) for mesh in meshes]) if color is None else color,
        np.concatenate(normals) if smooth else None,
    )


def _read(data: bytes, file_format: str, folder: Path | None) -> tuple[Any, list[Part]]:
    """Return trimesh's scene, and its meshes with their transforms to the file's frame."""
    import trimesh
    from trimesh.resolvers import FilePathResolver

    textures = FilePathResolver(str(folder)) if folder else None
    scene: Any = trimesh.load_scene(BytesIO(data), file_type=file_format, resolver=textures)
    placements = (scene.graph[node] for node in scene.graph.nodes_geometry)
    parts = [(scene.geometry[name], place) for place, name in placements]
    return scene, [(mesh, place) for mesh, place in parts if isinstance(mesh, trimesh.Trimesh)]


def _colors(part: Any) -> Float32s:
    """Return the colors of a part's vertices, shape (V, 4): of its texture, or of its material.

    RViz ignores the colors of vertices.
    """
    visual, colors = part.visual, _PLAIN
    if visual.kind == "texture":
        # OBJ has simple materials, DAE has materials for physically based rendering.
        material = visual.material
        image = getattr(material, "image", None) or getattr(material, "baseColorTexture", None)
        if image is not None and visual.uv is not None:
            colors = visual.to_color().vertex_colors / np.float32(255)
        else:
            colors = material.main_color / np.float32(255)
    return np.broadcast_to(colors, (len(part.vertices), 4))
