"""RViz's Marker and MarkerArray displays.

`DRAW` maps each marker type to the function that converts a message to drawables. `MarkerStore`
keeps the markers of a display by namespace and id, from their message to their deletion or expiry,
by the rules of RViz2's MarkerCommon. `_RULES` are hints about markers that RViz draws unexpectedly,
or not at all, without a status.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from course_lib.arrays import Floats, Matrix, Pixels
from course_lib.displays.display import (
    FILTER_PROPERTIES,
    QUEUE_LABEL,
    Context,
    Display,
    Subscription,
    TopicDisplay,
    node_name,
    qos_properties,
)
from course_lib.displays.frames import NS, is_unit, nanoseconds, pose_in_fixed_frame
from course_lib.displays.images import decode_compressed
from course_lib.displays.properties import Property, booleans
from course_lib.displays.shapes import (
    ALONG_X,
    alpha_drawn_twice,
    fields_of,
    placement,
    points_of,
    rotation_to,
)
from course_lib.displays.statuses import Level, Statuses, StatusRow
from course_lib.errors import CourseError
from course_lib.robots.robot import resolve
from course_lib.viewer.drawables import (
    OPAQUE_FROM,
    Drawable,
    Lines,
    Mesh,
    Points,
    Shape,
    Solids,
    Spot,
    Text,
    load_mesh,
    subdivide,
)
from course_lib.viewer.encoding import missing_characters

SOLIDS: dict[int, Shape] = {1: "box", 2: "sphere", 3: "cylinder"}
_FLAT: tuple[Level, str] = ("warn", "Scale of 0 in one of x/y/z")
LINE_STRIP, LINE_LIST, CUBE_LIST, SPHERE_LIST, POINTS = 4, 5, 6, 7, 8
SPOTS: dict[int, Spot] = {CUBE_LIST: "box", SPHERE_LIST: "sphere", POINTS: "square"}


@dataclass(frozen=True)
class MarkerDrawing:
    """The drawables of one marker, in the frame of its pose."""

    drawables: Mapping[str, Drawable] = field(default_factory=dict)  # by name
    # RViz's status, or None.
    status: tuple[Level, str] | None = None
    # Whether RViz rejects the message before it looks up a transform.
    is_rejected: bool = False


def rejected_drawing(text: str) -> MarkerDrawing:
    """Return the drawing for a message that RViz rejects: no drawables, and an error."""
    return MarkerDrawing(status=("error", text), is_rejected=True)


def rgba(color: Any) -> Floats:
    """Convert a std_msgs/msg/ColorRGBA, clipped to 0..1, shape (4,)."""
    values: Floats = np.clip([color.r, color.g, color.b, color.a], 0.0, 1.0)
    return values


def scale_of(marker: Any) -> Floats:
    """Return the scale of a marker, shape (3,)."""
    return np.array([marker.scale.x, marker.scale.y, marker.scale.z])


def colors(marker: Any) -> Floats:
    """Return the colors of a marker's points, shape (N, 4).

    NaN becomes 0; RViz does not check for NaN.
    """
    values: Floats = np.clip(np.nan_to_num(fields_of(marker.colors, "r", "g", "b", "a")), 0.0, 1.0)
    return values


def label(marker: Any) -> str:
    """Return RViz's name for a marker's status."""
    return f"{marker.ns}/{marker.id}"


# Fractions of an arrow's length.
SHAFT, HEAD = 0.77, 0.23


def solid(marker: Any) -> MarkerDrawing:
    """Draw a cube, a sphere or a cylinder; the scale is its full extent."""
    scale = scale_of(marker)
    placement = np.diag([*scale, 1.0])
    body = Solids(SOLIDS[marker.type], [placement], rgba(marker.color))
    return MarkerDrawing({"body": body}, None if scale.all() else _FLAT)


def arrow(marker: Any) -> MarkerDrawing:
    """Draw an arrow along +x of the pose, or between two points given in the frame of the pose.

    With two points, the scale contains the diameters of shaft and head, and the head length.
    """
    if len(marker.points) == 1:
        return rejected_drawing(
            f"Arrow marker [{label(marker)}] only specified one point of a point to point arrow."
        )
    scale, color = scale_of(marker), rgba(marker.color)
    status: tuple[Level, str] | None = None
    if len(marker.points) == 2:
        start, end = points_of(marker)
        distance = float(np.linalg.norm(end - start))
        shaft_diameter, head_diameter, head_length = scale
        if shaft_diameter + head_diameter == 0:
            status = ("warn", "Scale of 0 in both x and y")
        if not distance:
            return MarkerDrawing(status=status)
        head_length = min(max(head_length, 0.0), distance) if head_length else HEAD * distance
        shaft_length = distance - head_length
        along = rotation_to((end - start) / distance)
        shaft_size = (shaft_diameter, shaft_diameter, shaft_length)
        head_size = (head_diameter, head_diameter, head_length)
        shaft = placement(along, shaft_size, start + along[:, 2] * shaft_length / 2)
        head = placement(along, head_size, end - along[:, 2] * head_length / 2)
    else:
        length, width, height = scale
        shaft = placement(ALONG_X, (width, height, SHAFT * length), (SHAFT * length / 2, 0.0, 0.0))
        head_center = ((SHAFT + HEAD / 2) * length, 0.0, 0.0)
        head = placement(ALONG_X, (2 * width, 2 * height, HEAD * length), head_center)
        status = None if scale.all() else _FLAT
    return MarkerDrawing(
        {"shaft": Solids("cylinder", [shaft], color), "head": Solids("cone", [head], color)}, status
    )


def text(marker: Any) -> MarkerDrawing:
    """Draw text that faces the viewer.

    z of the scale is the height of a capital letter and x, if it is not 0, the width of a space.
    """
    height, space_width = marker.scale.z, marker.scale.x
    if not height or not marker.text:
        return MarkerDrawing()
    return MarkerDrawing(
        {"text": Text(marker.text, abs(height), rgba(marker.color), space_width=abs(space_width))}
    )


def lines(marker: Any) -> MarkerDrawing:
    """Draw billboard lines; x of the scale is their width."""
    strip = marker.type == LINE_STRIP
    if not strip and len(marker.points) % 2:
        return MarkerDrawing(
            status=("error", f"Line list marker [{label(marker)}] has an odd number of points.")
        )
    if len(marker.points) < 2 or not marker.scale.x:
        return MarkerDrawing()
    each = colors(marker) if has_colors(marker) else rgba(marker.color)
    return MarkerDrawing({"lines": Lines(points_of(marker), each, abs(marker.scale.x), strip)})


def spots(marker: Any) -> MarkerDrawing:
    """Draw a square, a box or a sphere at each point, as RViz's point clouds do.

    RViz draws spheres as discs that face the viewer, with the x and y of the scale.
    """
    if not marker.points:
        return MarkerDrawing()
    # RViz multiplies the alphas of material and point, so the alpha of a single color is applied
    # twice. It also draws each point twice, as a part of the cloud and as a separate object
    # (point_cloud.cpp).
    if has_colors(marker):
        each = colors(marker)
    else:
        each = np.tile(rgba(marker.color), (len(marker.points), 1))
        each[:, 3] **= 2
    each[:, 3] = alpha_drawn_twice(each[:, 3])
    status: tuple[Level, str] = ("warn", "All points have a zero alpha value.")
    warning = status if has_colors(marker) and not each[:, 3].any() else None
    size = tuple(abs(scale_of(marker)))
    return MarkerDrawing({"spots": Points(points_of(marker), each, size, spot=SPOTS[marker.type])}, warning)


def has_colors(marker: Any) -> bool:
    """Return whether RViz uses the colors of the points, which requires one color per point."""
    return len(marker.colors) == len(marker.points)


def mesh(marker: Any) -> MarkerDrawing:
    """Draw a mesh, multiplying its units by the scale."""
    uri = marker.mesh_resource
    if not uri:
        return MarkerDrawing()
    try:
        loaded = load_mesh(resolve(uri))
    except CourseError:
        return rejected_drawing(f"Mesh resource marker [{label(marker)}] could not load [{uri}]")
    colors, scale = rgba(marker.color), scale_of(marker)
    if marker.mesh_use_embedded_materials:
        # The color of the marker tints the mesh's own materials. RViz draws each material with the
        # alpha of the marker, and the tint above it with half of its strength at most. Without any
        # color there is no tint, and the mesh is opaque.
        tint, is_tinted = rgba(marker.color), rgba(marker.color).any()
        alpha = tint[3] if is_tinted else 1.0
        strength = min(alpha, 0.5) if is_tinted else 0.0
        if _is_stl(marker):
            # STL has no materials, so only the tint is drawn: black without any color.
            colors = np.array([*tint[:3], 1.0 if alpha >= OPAQUE_FROM else strength])
        else:
            opacity = 1 - (1 - alpha) * (1 - strength)
            colors = loaded.colors.astype(float)
            colors[..., :3] = (1 - strength) * alpha * colors[..., :3] + strength * tint[:3]
            colors[..., :3] /= opacity or 1.0
            colors[..., 3] = opacity
    # Nonuniform scaling changes normals.
    normals = loaded.normals if scale.min() == scale.max() > 0 else None
    return MarkerDrawing({"mesh": Mesh(loaded.vertices * scale, loaded.faces, colors, normals)})


def _is_stl(marker: Any) -> bool:
    return bool(marker.type == _MESH and marker.mesh_resource.lower().endswith(".stl"))


def triangles(marker: Any) -> MarkerDrawing:
    """Draw two-sided triangles, shaded only if they have no colors of their own."""
    count = len(marker.points)
    if not count:
        return rejected_drawing(f"TriMesh marker [{label(marker)}] has no points.")
    if count % 3:
        return rejected_drawing(
            f"TriMesh marker [{label(marker)}] has a point count which is not divisible by 3 [{count}]"
        )
    scale = scale_of(marker)
    status: tuple[Level, str] | None = None if scale.all() else _FLAT
    textured = _textured_triangles(marker, scale)
    if textured is not None:
        return MarkerDrawing({"mesh": textured}, status)
    # RViz multiplies alphas, but blends only if a corner's color is transparent or, with one color
    # per triangle, if the marker's color is.
    each, is_blended = None, False
    if has_colors(marker):
        each = colors(marker)
        is_blended = each[:, 3].min() < OPAQUE_FROM
    elif has_face_colors(marker):
        each = np.repeat(colors(marker), 3, axis=0)
        is_blended = marker.color.a < OPAQUE_FROM
    if each is not None:
        each[:, 3] = each[:, 3] * rgba(marker.color)[3] if is_blended else 1.0
    color = rgba(marker.color) if each is None else each
    mesh = Mesh(points_of(marker) * scale, None, color, lit=each is None)
    return MarkerDrawing({"mesh": mesh}, status)


_EMBEDDED = "embedded://"
# The number of steps along a side of a textured triangle, of which each shows one color.
_TEXTURE_STEPS = 160


def _textured_triangles(marker: Any, scale: Floats) -> Mesh | None:
    """Return small triangles in the colors of the embedded texture, or None if RViz draws none.

    The texture is repeated beyond 0 and 1, and v is 0 at the top of the image. A single color of
    the marker multiplies it; the colors of points have no effect.
    """
    pixels = _texture_of(marker) if _uses_texture(marker) else None
    if pixels is None:
        return None
    uv = np.nan_to_num(fields_of(marker.uv_coordinates, "u", "v")).reshape(-1, 3, 2)
    # Moved inwards a little, so that a corner at 1 has the color of the last column, not the first.
    uv += 1e-6 * (uv.mean(axis=1, keepdims=True) - uv)
    points = (points_of(marker) * scale).reshape(-1, 3, 3)
    vertices, at, faces = subdivide(points, uv, _TEXTURE_STEPS)
    rows, columns = pixels.shape[:2]
    places = np.minimum((at % 1.0 * (columns, rows)).astype(int), (columns - 1, rows - 1))
    colors = np.ones((len(vertices), 4))
    colors[:, : pixels.shape[2]] = pixels[places[:, 1], places[:, 0]] / 255
    if not has_colors(marker) and not has_face_colors(marker):
        colors *= rgba(marker.color)
    return Mesh(vertices, faces, colors)


def _has_uv_per_point(marker: Any) -> bool:
    """Return whether there is one texture coordinate per point, as RViz requires."""
    return len(marker.uv_coordinates) == len(marker.points)


def _uses_texture(marker: Any) -> bool:
    """Return whether RViz looks for an embedded texture."""
    return bool(marker.texture_resource.startswith(_EMBEDDED)) and _has_uv_per_point(marker)


class _Texture(NamedTuple):
    """The fields of a sensor_msgs/msg/CompressedImage, as a key of a cache."""

    format: str
    data: bytes


def _texture_of(marker: Any) -> Pixels | None:
    """Return the pixels of the embedded texture, or None if it is not an image."""
    return _decode(_Texture(marker.texture.format, bytes(marker.texture.data)))


# The drawing and the hints of a marker need the same image, and so does a repeated marker.
@lru_cache(maxsize=1)
def _decode(texture: _Texture) -> Pixels | None:
    try:
        return decode_compressed(texture, lambda values: (0.0, 65535.0), "RGBA")
    except ValueError:
        return None


def has_face_colors(marker: Any) -> bool:
    """Return whether there is one color per triangle."""
    return len(marker.colors) == len(marker.points) // 3


# The function that draws each type, by the constants of visualization_msgs/msg/Marker.
DRAW: Mapping[int, Callable[[Any], MarkerDrawing]] = {
    0: arrow,
    **dict.fromkeys(SOLIDS, solid),
    **dict.fromkeys((LINE_STRIP, LINE_LIST), lines),
    **dict.fromkeys(SPOTS, spots),
    9: text,
    10: mesh,
    11: triangles,
}


# RViz does not draw type 12.
_TEXT, _MESH, _TRIANGLES = 9, 10, 11
# Maximum number of characters that are looked up in the fonts.
_MOST_CHARACTERS = 100
# A number of points that takes 0.1 s to create and 0.1 s to draw.
_MANY = 100_000
_LISTS = (LINE_STRIP, LINE_LIST, 6, 7, POINTS)


class Rule(NamedTuple):
    """A problem that RViz does not report: a predicate, and a format string for the marker."""

    holds: Callable[[Any], bool]
    text: str


def hints(marker: Any) -> tuple[str, ...]:
    """Return the hints about a marker."""
    boxes = missing_characters(marker.text[:_MOST_CHARACTERS]) if marker.type == _TEXT else ""
    format_values = {"m": marker, "q": marker.pose.orientation, "n": len(marker.points), "boxes": boxes}
    return tuple(rule.text.format(**format_values) for rule in _RULES if rule.holds(marker))


def _uses_own_color(marker: Any) -> bool:
    """Return whether the marker's own color is used."""
    uses_mesh_material = marker.type == _MESH and marker.mesh_use_embedded_materials
    each = marker.type in (*_LISTS, _TRIANGLES) and bool(marker.colors) and _colors_fit(marker)
    return not uses_mesh_material and not each


def _colors_fit(marker: Any) -> bool:
    return has_colors(marker) or (marker.type == _TRIANGLES and has_face_colors(marker))


def _is_zero(marker: Any) -> bool:
    q = marker.pose.orientation
    return not any((q.x, q.y, q.z, q.w))


_RULES = (
    Rule(
        lambda m: not 0 <= m.type <= _TRIANGLES,
        "RViz2 cannot draw type {m.type}: it logs 'Unknown marker type: {m.type}' and draws nothing.",
    ),
    Rule(
        lambda m: m.type == _TEXT and bool(missing_characters(m.text[:_MOST_CHARACTERS])),
        "No font here has the characters {boxes!r}, so boxes are drawn. Write the text in Latin letters.",
    ),
    Rule(
        lambda m: _uses_own_color(m) and m.color.a == 0.0,
        "color.a is 0, so the marker is invisible. Set color.a = 1.0 (0 is the default).",
    ),
    Rule(
        lambda m: m.type in (*_LISTS, _TRIANGLES) and bool(m.colors) and not _colors_fit(m),
        "colors does not have one entry for each point, so RViz2 ignores it and uses color.",
    ),
    Rule(
        lambda m: len(m.points) > _MANY,
        "{n:,} points make every message slow, because each is a Python object. Publish fewer, "
        "or a PointCloud2 created from a numpy array.",
    ),
    Rule(
        lambda m: m.type in _LISTS and not m.points,
        "points is empty: nothing is drawn.",
    ),
    Rule(
        lambda m: m.type in (LINE_STRIP, LINE_LIST) and not m.scale.x,
        "scale.x, the width of the line in metres, is 0: nothing is drawn.",
    ),
    Rule(
        lambda m: m.type == POINTS and not (m.scale.x and m.scale.y),
        "scale.x and scale.y, the size of the points in metres, must not be 0: nothing is drawn.",
    ),
    Rule(
        lambda m: m.type in (6, 7) and not (m.scale.x and m.scale.y and m.scale.z),
        "scale is 0 in one of x/y/z: nothing or something flat is drawn.",
    ),
    Rule(
        lambda m: m.type == _TEXT and not m.scale.z,
        "scale.z, the height of the letters in metres, is 0: nothing is drawn.",
    ),
    Rule(lambda m: m.type == _TEXT and not m.text, "text is empty: nothing is drawn."),
    Rule(lambda m: m.type == _MESH and not m.mesh_resource, "mesh_resource is empty: nothing is drawn."),
    Rule(
        lambda m: m.mesh_use_embedded_materials and _is_stl(m) and not rgba(m.color).any(),
        "STL files have no materials, so this mesh has the color of the field color: black. Set it.",
    ),
    Rule(
        lambda m: (
            m.type == _TRIANGLES and bool(m.texture_resource) and not m.texture_resource.startswith(_EMBEDDED)
        ),
        "texture_resource is {m.texture_resource!r}: RViz2 draws a texture only if the name begins "
        "with embedded:// and the field texture has the image.",
    ),
    Rule(
        lambda m: m.type == _TRIANGLES and bool(m.texture_resource) and not _has_uv_per_point(m),
        "uv_coordinates does not have one entry for each point, so RViz2 ignores the texture.",
    ),
    Rule(
        lambda m: m.type == _TRIANGLES and _uses_texture(m) and _texture_of(m) is None,
        "texture.data is not a PNG or JPEG file, so the texture is not drawn.",
    ),
    Rule(
        _is_zero,
        "orientation is (0, 0, 0, 0), not a valid quaternion: RViz2 turns it into half a turn "
        "about z of the fixed frame. Set orientation.w = 1.0.",
    ),
    Rule(
        lambda m: not is_unit(m.pose.orientation, 1e-3) and not _is_zero(m),
        "orientation ({q.x:g}, {q.y:g}, {q.z:g}, {q.w:g}) does not have length 1: RViz2 draws a "
        "wrong rotation. Divide it by its length.",
    ),
)


ADD, DELETE, DELETEALL = 0, 2, 3
# Lifetimes up to this value are unlimited [ns].
FOREVER_NS = 100_000
# The motion after which a marker's position is outdated, [m] and [rad].
_MOVED = 0.01

Key: TypeAlias = tuple[str, int]  # (namespace, id)


@dataclass
class DisplayedMarker:
    """A marker in the scene."""

    # The marker's last message.
    marker: Any
    drawn: MarkerDrawing
    # The path of the marker's scene node.
    path: str
    # Robot time of reception [ns].
    received_ns: int
    # Whether its node is visible.
    is_visible: bool = True
    # The transform that was used last; None if it is unknown.
    transform_frame_to_fixed: Matrix | None = None

    @property
    def expires_ns(self) -> float:
        """Robot time at which it expires [ns].

        The lifetime counts from reception, not from the stamp.
        """
        lifetime_ns = nanoseconds(self.marker.lifetime)
        return self.received_ns + lifetime_ns if lifetime_ns > FOREVER_NS else math.inf


class MarkerStore:
    """The markers of one display, below its node of the scene."""

    def __init__(self, context: Context, path: str, statuses: Statuses) -> None:
        self._context = context
        self._path = path
        self._statuses = statuses
        self._queue: list[tuple[Any, int]] = []
        self.displayed: dict[Key, DisplayedMarker] = {}
        # Markers that expire or move with a frame. Visiting all markers in each frame would keep a
        # processor busy.
        self._changing: dict[Key, DisplayedMarker] = {}
        self.namespaces: dict[str, bool] = {}

    def add(self, markers: Iterable[Any]) -> None:
        """Queue messages for the next frame."""
        self._queue += [(marker, self._context.now_ns) for marker in markers]

    def add_array(self, array: Any) -> None:
        """Queue the messages of a MarkerArray.

        Duplicate markers are an error, but both are drawn.
        """
        name = "Duplicate Marker Check"
        self._statuses.delete(name)
        keys: set[Key] = set()
        for ns, number in ((marker.ns, marker.id) for marker in array.markers):
            if (ns, number) in keys:
                problem = "Multiple Markers in the same MarkerArray message had the same ns and id"
                self._statuses.set("error", name, f"{problem}: ({ns}, {number})")
                break
            keys.add((ns, number))
        self.add(array.markers)

    def update(self) -> None:
        """Draw new markers, remove expired ones, and move markers locked to their frame."""
        queue, self._queue = self._queue, []
        for marker, received_ns in queue:
            key = (marker.ns, marker.id)
            if not _is_finite(marker):
                problem = "Contains invalid floating point values (nans or infs)"
                self._statuses.set("error", label(marker), problem)
            elif marker.action == ADD:
                self._show(key, marker, received_ns)
            elif marker.action == DELETE:
                self._delete(key)
            elif marker.action == DELETEALL:
                for other in list(self.displayed):
                    if marker.ns in ("", other[0]):
                        self._delete(other)
            else:
                self._statuses.hint(label(marker), f"RViz's log: Unknown marker action: {marker.action}")
        many = [_MANY_MARKERS_HINT.format(len(self.displayed))] if len(self.displayed) > _MANY_MARKERS else []
        self._statuses.hint("Markers", *many)
        for key, live in list(self._changing.items()):
            if live.expires_ns <= self._context.now_ns:
                self._delete(key)
                if not self.displayed:
                    lifetime = nanoseconds(live.marker.lifetime) / NS  # [s]
                    self._statuses.hint(
                        "Lifetime", f"the last marker expired: its lifetime is {lifetime:g} s."
                    )
            elif live.marker.frame_locked and (
                not live.drawn.is_rejected and self._transform(live) is not live.transform_frame_to_fixed
            ):
                self._place_marker(live)

    def clear(self) -> None:
        """Remove all markers."""
        for live in self.displayed.values():
            self._context.scene.delete(live.path)
        self.displayed.clear()
        self._changing.clear()
        self._queue.clear()

    def set_namespaces(self, namespaces: Mapping[str, bool]) -> None:
        """Show or hide namespaces. Hiding a namespace removes its markers."""
        self.namespaces |= namespaces
        self._statuses.hint("Namespaces")
        for key in list(self.displayed):
            if not self.namespaces.get(key[0], True):
                self._delete(key)

    def moved_frame_hints(self) -> Iterator[tuple[str, str]]:
        """Yield name and hint of each marker whose frame has moved within a second of its reception."""
        for live in self.displayed.values():
            frame, then = live.marker.header.frame_id, live.transform_frame_to_fixed
            now = self._context.frames.transform(frame)
            fresh = self._context.now_ns < live.received_ns + NS
            if fresh or live.marker.frame_locked or then is None or now is None:
                continue
            if np.abs(now - then).max() > _MOVED:
                text = "has moved since this marker arrived; RViz2 places it once. frame_locked=True follows."
                yield label(live.marker), f"{frame} {text}"

    def _show(self, key: Key, marker: Any, received_ns: int) -> None:
        if not self.namespaces.setdefault(marker.ns, True):
            self._statuses.hint("Namespaces", f"{marker.ns!r} is not enabled: its markers are not shown.")
            return
        name = label(marker)
        self._statuses.delete(name)
        self._statuses.hint("Lifetime")
        before = self.displayed.get(key)
        live = self.displayed[key] = self._draw(marker, received_ns, before)
        self._changing.pop(key, None)
        if marker.frame_locked or math.isfinite(live.expires_ns):
            self._changing[key] = live
        if live.drawn.is_rejected:
            self._report_drawing(live)
        else:
            self._place_marker(live)
        # If the stamps differ, both messages have waited in the queue for a transform.
        is_repeated = (
            before is not None
            and before.received_ns == received_ns
            and before.marker.header.stamp == marker.header.stamp
        )
        self._statuses.hint(name, *hints(marker), *([_REPEATED] if is_repeated else []))

    def _draw(
        self,
        marker: Any,
        received_ns: int,
        before: DisplayedMarker | None,
    ) -> DisplayedMarker:
        """Put a marker's drawing into the scene, or reuse the existing one if it is equal."""
        # A locked marker moves with its frame.
        base = f"{self._path}/{node_name(marker.ns)}/{marker.id}"
        frame = marker.header.frame_id.removeprefix("/")
        path = f"frames/{node_name(frame)}/{base}" if marker.frame_locked else base
        scene = self._context.scene
        if (
            before
            and before.path == path
            and _drawing_key(marker)
            and _drawing_key(marker) == _drawing_key(before.marker)
        ):
            return DisplayedMarker(marker, before.drawn, path, received_ns, before.is_visible)
        if before and before.path != path:
            scene.delete(before.path)
            before = None
        drawing = DRAW[marker.type](marker) if marker.type in DRAW else MarkerDrawing()
        for part in before.drawn.drawables.keys() - drawing.drawables.keys() if before else ():
            scene.delete(f"{path}/{part}")
        for part, drawable in drawing.drawables.items():
            scene.set_object(f"{path}/{part}", drawable)
        is_visible = before.is_visible if before else True
        return DisplayedMarker(marker, drawing, path, received_ns, is_visible)

    def _place_marker(self, live: DisplayedMarker) -> None:
        """Place a marker by the transform at its stamp, or in its frame if it is locked to it."""
        marker, scene = live.marker, self._context.scene
        frame, stamp_ns = marker.header.frame_id, nanoseconds(marker.header.stamp)
        transform = self._transform(live)
        if live.is_visible != (transform is not None):
            live.is_visible = not live.is_visible
            scene.set_visible(live.path, live.is_visible)
        first, live.transform_frame_to_fixed = live.transform_frame_to_fixed is None, transform
        if transform is None:
            problem = self._context.frames.problem(frame, stamp_ns) or ""
            self._statuses.set("error", label(marker), problem)
            return
        self._report_drawing(live)
        pose = pose_in_fixed_frame(transform, marker.pose)
        if not marker.frame_locked:
            scene.set_transform(live.path, pose)
        elif first or not is_unit(marker.pose.orientation):
            scene.set_transform(live.path, np.linalg.inv(transform) @ pose)

    def _transform(self, live: DisplayedMarker) -> Matrix | None:
        header = live.marker.header
        if not live.marker.frame_locked:
            return self._context.frames.transform(header.frame_id, nanoseconds(header.stamp))
        followed = self._context.follow_frame(header.frame_id)
        return followed[1] if followed else None

    def _report_drawing(self, live: DisplayedMarker) -> None:
        if live.drawn.status:
            level, text = live.drawn.status
            self._statuses.set(level, label(live.marker), text)

    def _delete(self, key: Key) -> None:
        self._statuses.delete(f"{key[0]}/{key[1]}")
        live = self.displayed.pop(key, None)
        self._changing.pop(key, None)
        if live:
            self._context.scene.delete(live.path)


# A number of markers that takes about 1 s to create and to send.
_MANY_MARKERS = 5_000
_MANY_MARKERS_HINT = (
    "{:,} markers make this view and RViz2 slow, because each is an object of its own. "
    "Publish one marker of type CUBE_LIST, SPHERE_LIST or LINE_LIST with many points."
)
_REPEATED = (
    "two markers with this ns and id arrived together: only the last is visible. Give each its own id."
)


def _drawing_key(marker: Any) -> tuple[Any, ...] | None:
    """Return a key with a drawing's inputs, or None if comparing costs as much as drawing."""
    if len(marker.points) or len(marker.colors):
        return None
    s, c = marker.scale, marker.color
    return (
        (marker.type, s.x, s.y, s.z, c.r, c.g, c.b, c.a),
        (marker.text, marker.mesh_resource, marker.mesh_use_embedded_materials),
    )


def _is_finite(marker: Any) -> bool:
    """Return whether all numbers that RViz checks are finite, which excludes colors of points."""
    pose, s, c = marker.pose, marker.scale, marker.color
    p, q = pose.position, pose.orientation
    numbers = (p.x, p.y, p.z, q.x, q.y, q.z, q.w, s.x, s.y, s.z, c.r, c.g, c.b, c.a)
    return all(map(math.isfinite, numbers)) and all(
        math.isfinite(point.x + point.y + point.z) for point in marker.points
    )


MARKER, MARKER_ARRAY = "visualization_msgs/msg/Marker", "visualization_msgs/msg/MarkerArray"
_NAMESPACES = Property("Namespaces", {}, booleans)


def _namespace(label: str) -> str | None:
    """Return the namespace in a label like ``Namespaces/labels``, or None."""
    above, slash, name = label.partition("/")
    return name if slash and above.lower() == "namespaces" else None


class _Markers(TopicDisplay):
    """Base class of the Marker and MarkerArray displays."""

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self.markers = MarkerStore(self.context, self.path, self.statuses)

    def __getitem__(self, label: str) -> Any:
        name = _namespace(label)
        return super().__getitem__(label) if name is None else self.markers.namespaces.get(name, True)

    def __setitem__(self, label: str, value: Any) -> None:
        name = _namespace(label)
        super().__setitem__(*((label, value) if name is None else ("Namespaces", {name: value})))

    def on_property_change(self, label: str) -> None:
        """Show or hide namespaces; handle other properties as usual."""
        super().on_property_change(label)
        if label == "Namespaces":
            self.markers.set_namespaces(self["Namespaces"])

    def update(self) -> None:
        """Draw new markers, remove expired ones, and move markers locked to their frame."""
        super().update()
        self.markers.update()
        self._values["Namespaces"] = dict(self.markers.namespaces)

    def message_at(self, path: str) -> Any:
        """Return the marker from which an object was drawn."""
        live = self.markers.displayed.values()
        return next((shown.marker for shown in live if f"{path}/".startswith(f"{shown.path}/")), None)

    def rows(self) -> list[StatusRow]:
        """Return the statuses, with hints about markers whose frame has moved."""
        frame_hints = self.markers.moved_frame_hints() if self.enabled else ()
        return super().rows() + [StatusRow(self.name, name, "hint", text) for name, text in frame_hints]

    def reset(self) -> None:
        """Remove all markers."""
        super().reset()
        self.markers.clear()


class MarkerDisplay(_Markers):
    """Markers, drawn with a known transform; arrays on ``<topic>_array`` are drawn immediately."""

    queue_label = QUEUE_LABEL
    class_name = "rviz_default_plugins/Marker"
    type_name = MARKER
    properties = (*FILTER_PROPERTIES, _NAMESPACES)

    def make_subscriptions(self) -> tuple[Subscription, ...]:
        """Subscribe to the topic, and to the topic of arrays."""
        self.statuses.set("ok", "Array Topic", "OK")
        array = self.subscription(self["Topic"] + "_array", MARKER_ARRAY, self.markers.add_array)
        return (*super().make_subscriptions(), array)

    def process(self, message: Any) -> None:
        """Show a marker."""
        self.markers.add([message])


class MarkerArrayDisplay(_Markers):
    """Arrays of markers. They do not wait: a marker with an unknown transform is an error."""

    class_name = "rviz_default_plugins/MarkerArray"
    type_name = MARKER_ARRAY
    properties = (*Display.properties, *qos_properties("visualization_marker_array"), _NAMESPACES)

    def process(self, message: Any) -> None:
        """Show an array."""
        self.markers.add_array(message)
