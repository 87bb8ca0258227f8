"""RViz's TF, Axes and Grid displays, which have no Topic property."""

import re
from collections.abc import Callable, Mapping
from functools import lru_cache, partial, reduce
from importlib import import_module
from math import floor
from typing import Any, ClassVar, NamedTuple, TypeAlias

import numpy as np

from course_lib.arrays import Matrix
from course_lib.displays.display import Display, node_name
from course_lib.displays.frames import FIXED_FRAME, NS
from course_lib.displays.properties import (
    Property,
    color,
    flag,
    frame,
    integer,
    number,
    read_only,
    text,
    vector,
    words,
)
from course_lib.displays.shapes import AXIS_COLORS, axes, placement, rotation_to
from course_lib.viewer.drawables import Drawable, Lines, Solids, Text
from course_lib.viewer.scene import Scene

# Directions of the grid's x, normal and z in the reference frame (grid_display.cpp:updatePlane).
_PLANES = {
    "XY": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "XZ": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "YZ": ((0, 0, 1), (-1, 0, 0), (0, -1, 0)),
}
_MOST_LINES = 100_000


class ReferenceDisplay(Display):
    """Base class of displays that depend only on their properties, and follow their Reference Frame."""

    # RViz's statuses. The second one is a format string for the reference frame, the fixed frame and
    # tf2's reason.
    transform_ok: ClassVar[str]
    transform_problem: ClassVar[str]
    properties = (*Display.properties, Property("Reference Frame", FIXED_FRAME, frame))

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._drawn_transform: Matrix | None = None
        self._is_drawn = False

    def drawing(self) -> Drawable:
        """Return the drawable."""
        raise NotImplementedError

    def offset(self) -> Matrix:
        """Return the transform from the drawable to the reference frame, shape (4, 4)."""
        return np.eye(4)

    def on_property_change(self, label: str) -> None:
        """Redraw in the next frame."""
        super().on_property_change(label)
        self._is_drawn = False

    def reset(self) -> None:
        """Redraw in the next frame."""
        super().reset()
        self._is_drawn = False

    def update(self) -> None:
        """Draw, and follow the reference frame."""
        if not (self.enabled and self.context.is_drawn):
            return
        name = self["Reference Frame"]
        reference = self.context.frames.fixed_frame if name == FIXED_FRAME else name
        transform = self.context.frames.transform(reference)
        if transform is not None:
            self.statuses.set("ok", "Transform", self.transform_ok)
        else:
            reason = self.context.frames.problem(reference) or ""
            problem = self.transform_problem.format(reference, self.context.frames.fixed_frame, reason)
            self.statuses.set("error", "Transform", problem)
        if transform is not self._drawn_transform or not self._is_drawn:
            self._drawn_transform, scene = transform, self.context.scene
            node = f"{self.path}/drawing"
            scene.set_visible(node, transform is not None)
            if transform is not None:
                scene.set_transform(node, transform @ self.offset())
            if not self._is_drawn:
                scene.set_object(node, self.drawing())
                self._is_drawn = True


class AxesDisplay(ReferenceDisplay):
    """The axes of a frame."""

    class_name = "rviz_default_plugins/Axes"
    transform_ok, transform_problem = "Transform OK", "{2}"
    properties = (
        *ReferenceDisplay.properties,
        Property("Length", 1.0, number(0.0001)),  # [m]
        Property("Radius", 0.1, number(0.0001)),  # [m]; RViz's name for the diameter
    )

    def drawing(self) -> Solids:
        """Return the three cylinders."""
        return axes(self["Length"], self["Radius"])


class GridDisplay(ReferenceDisplay):
    """Lines on a plane of a frame."""

    class_name = "rviz_default_plugins/Grid"
    transform_ok, transform_problem = "Ok", "Could not transform from [{}] to [{}]"
    properties = (
        *ReferenceDisplay.properties,
        Property("Plane Cell Count", 10, integer(1)),
        Property("Normal Cell Count", 0, integer(0)),
        Property("Cell Size", 1.0, number(0.0001)),  # [m]
        Property("Line Style", "Lines", words("Lines", "Billboards")),
        # [m]
        Property("Line Style/Line Width", 0.03, number(0.001), shown_if=(("Line Style", "Billboards"),)),
        Property("Color", (160, 160, 164), color),
        Property("Alpha", 0.5, number(0.0, 1.0)),
        Property("Plane", "XY", words(*_PLANES)),
        Property("Offset", (0.0, 0.0, 0.0), vector),  # [m]
    )

    def drawing(self) -> Lines:
        """Return the lines, in the grid's own frame."""
        rgba = (*(channel / 255 for channel in self["Color"]), self["Alpha"])
        width = self["Line Width"] if self["Line Style"] == "Billboards" else 0.0
        cells, layers = self["Plane Cell Count"] + 1, self["Normal Cell Count"]
        count = 2 * cells * (layers + 1) + cells**2 * (layers > 0)
        too_many = f"These cells have {count} lines; at most {_MOST_LINES} are drawn."
        self.statuses.hint("Cells", *([too_many] if count > _MOST_LINES else []))
        # The ends of all lines in pairs; y is the grid's normal.
        ends: list[tuple[float, float, float]] = []
        if count <= _MOST_LINES:
            extent, top = (self["Cell Size"] * number / 2 for number in (cells - 1, layers))
            steps = np.linspace(extent, -extent, cells)
            for y in np.linspace(top, -top, layers + 1):
                for step in steps:
                    ends += (step, y, -extent), (step, y, extent), (-extent, y, step), (extent, y, step)
            for x, z in ((x, z) for x in steps for z in steps if layers):
                ends += (x, -top, z), (x, top, z)
        return Lines(np.array(ends).reshape(-1, 3), rgba, width, strip=False)

    def offset(self) -> Matrix:
        """Return the transform from the plane to the reference frame, shape (4, 4)."""
        plane = np.eye(4)
        plane[:3, :3] = np.transpose(_PLANES[self["Plane"]])
        plane[:3, 3] = self["Offset"]
        return plane


# The names of the parent nodes of all frames' nodes.
PARTS = ("axes", "arrows", "names")

_LENGTH, _WIDTH = 0.2, 0.02  # length and width of an axis [m]
# Diameters of an arrow's shaft and head, and length of the head [m].
_SHAFT, _HEAD, _HEAD_LENGTH = 0.01, 0.04, 0.1
_SHAFT_COLOR, _HEAD_COLOR = np.array([0.8, 0.8, 0.3, 1.0]), np.array([1.0, 0.1, 0.6, 1.0])
_NAME_HEIGHT = 0.1  # [m]
_WHITE = np.ones(4)
_GREY = np.array([0.7, 0.7, 0.7, 1.0])
# Steps of fading within the timeout.
_STEPS = 48
_ALL = "Frames/All Enabled"
# Arrows up to this length [m] are not drawn.
_SHORTEST = 0.001
_FRAME_VALUES = ("Parent", "Position", "Orientation", "Relative Position", "Relative Orientation")


class Appearance(NamedTuple):
    """The appearance of a frame."""

    # Time since its last transform, relative to the timeout. The frame turns gray from 1/3 to 2/3
    # and fades out until 1.
    age: float
    # The value of Marker Scale.
    scale: float


class DrawnFrame:
    """Axes, name and an arrow to the parent. Invisible parts are not created."""

    def __init__(self, scene: Scene, path: str, frame: str) -> None:
        self._scene = scene
        self._frame = frame
        self.nodes = {part: f"{path}/{part}/{node_name(frame)}" for part in PARTS}
        self._drawn_appearances: dict[str, Appearance] = {}
        self._visibility: dict[str, bool] = {}
        self._last_transforms: tuple[Matrix | None, Matrix | None] = (None, None)

    def show(self, visible_parts: Mapping[str, bool], look: Appearance) -> None:
        """Show the requested parts, and hide the others."""
        look = Appearance(max(floor(look.age * _STEPS) / _STEPS, 1 / 3), look.scale)
        for part in PARTS:
            if visible_parts[part] and self._drawn_appearances.get(part) != look:
                self._drawn_appearances[part] = look
                self._last_transforms = (None, None)
                set_object, node = self._scene.set_object, self.nodes[part]
                if part == "axes":
                    set_object(
                        node, axes(look.scale * _LENGTH, look.scale * _WIDTH, _fade(AXIS_COLORS, look.age))
                    )
                elif part == "names":
                    height = look.scale * _NAME_HEIGHT
                    set_object(node, Text(self._frame, height, _fade(_WHITE, look.age), below=True))
                else:
                    set_object(
                        f"{node}/shaft", Solids("cylinder", [np.eye(4)], _fade(_SHAFT_COLOR, look.age))
                    )
                    set_object(f"{node}/head", Solids("cone", [np.eye(4)], _fade(_HEAD_COLOR, look.age)))
            if part in self._drawn_appearances and self._visibility.get(part, True) != visible_parts[part]:
                self._visibility[part] = visible_parts[part]
                self._scene.set_visible(self.nodes[part], visible_parts[part])

    def place(self, transform: Matrix, transform_parent: Matrix | None, scale: float) -> None:
        """Move the frame; both transforms are to the fixed frame."""
        before, before_parent = self._last_transforms
        if before is transform and before_parent is transform_parent:
            return
        self._last_transforms = (transform, transform_parent)
        for part in self._drawn_appearances.keys() - {"arrows"}:
            self._scene.set_transform(self.nodes[part], transform)
        if "arrows" in self._drawn_appearances and transform_parent is not None:
            start, end = transform[:3, 3], transform_parent[:3, 3]
            length = float(np.linalg.norm(end - start))
            if not length:
                return
            direction = (end - start) / length
            # RViz shortens the head of a short arrow in the same way.
            head = _HEAD_LENGTH * scale * (length if length < _HEAD_LENGTH * scale else 1.0)
            rotation, node = rotation_to(direction), self.nodes["arrows"]
            sizes = ((_SHAFT * scale, length - head), (_HEAD * scale, head))
            centers = ((length - head) / 2, length - head / 2)
            for part, (width, along), center in zip(("shaft", "head"), sizes, centers, strict=True):
                transform = placement(rotation, (width, width, along), start + direction * center)
                self._scene.set_transform(f"{node}/{part}", transform)


def _fade(color: Matrix, age: float) -> Matrix:
    """Return RGBA faded by an age in units of the timeout."""
    if age <= 2 / 3:
        share = 2 - 3 * age
        faded: Matrix = share * color + (1 - share) * _GREY
        return faded
    fading: Matrix = np.broadcast_to(_GREY * [1, 1, 1, max(0.0, 3 - 3 * age)], color.shape)
    return fading


# A function from positions in a name, where a part of an expression starts, to possible end
# positions.
_Ends: TypeAlias = Callable[[str, set[int]], set[int]]
# Parts of Python's parsed expressions that match at most one character.
_SINGLE = {"LITERAL", "NOT_LITERAL", "IN", "ANY", "AT", "FAILURE"}


def _regex(value: Any) -> str:
    """Check a regular expression."""
    pattern = text(value)
    try:
        _compile(pattern)
    except (re.error, RecursionError) as error:
        raise ValueError(f"a regular expression; {error}") from None
    return pattern


@lru_cache(maxsize=64)
def _compile(pattern: str) -> _Ends:
    """Compile a regular expression to a function whose run time is polynomial.

    `re` tries all ways to match, one after the other. Expressions like ``(a+)+b`` would take
    forever, and nothing can interrupt the search. Only the parser and the parts for single
    characters are Python's.
    """
    # The only parser of Python's regular expressions is a private module of `re`.
    return _sequence(import_module("re._parser").parse(pattern))


def _sequence(parsed: Any) -> _Ends:
    parts = [_part(parsed, index) for index in range(len(parsed))]
    return lambda name, starts: reduce(lambda ends, part: part(name, ends), parts, starts)


def _part(parsed: Any, index: int) -> _Ends:
    code, argument = parsed[index]
    kind = str(code)
    if kind in ("MAX_REPEAT", "MIN_REPEAT"):
        return partial(_repeat, _sequence(argument[2]), *argument[:2])
    if kind == "BRANCH":
        branches = [_sequence(branch) for branch in argument[1]]
        return lambda name, starts: {end for branch in branches for end in branch(name, starts)}
    if kind == "SUBPATTERN":
        return _sequence(argument[-1])
    if kind in ("ASSERT", "ASSERT_NOT") and argument[0] > 0:
        ahead = _sequence(argument[1])
        return lambda name, starts: {s for s in starts if bool(ahead(name, {s})) == (kind == "ASSERT")}
    if kind in _SINGLE:
        single = import_module("re._compiler").compile(parsed[index : index + 1])
        return lambda name, starts: {match.end() for s in starts if (match := single.match(name, s))}
    raise ValueError(
        "a regular expression without references to groups like '\\1', lookbehind and atomic "
        "groups, which the filters do not support"
    )


def _repeat(body: _Ends, low: int, high: int, name: str, starts: set[int]) -> set[int]:
    """Return the ends of `low` to `high` repetitions."""
    for _ in range(low):
        before, starts = starts, body(name, starts)
        # Further repetitions do not add an end.
        if starts == before:
            break
    ends, new, count = starts, starts, low
    while new and count < high:
        new = body(name, new) - ends
        ends, count = ends | new, count + 1
    return ends


@lru_cache(maxsize=4096)
def _passes(name: str, whitelist: str, blacklist: str) -> bool:
    """Return whether a frame passes both filters. An empty filter accepts all frames."""
    starts = set(range(len(name) + 1))
    return bool(_compile(whitelist)(name, starts)) and not (blacklist and _compile(blacklist)(name, starts))


class _LatestTransform(NamedTuple):
    """The latest transform of a frame to the fixed frame, and the time of its arrival."""

    transform: Matrix | None
    # 0 if the transform is static or unknown.
    stamp_ns: int
    received_ns: int


class TfDisplay(Display):
    """The frames in tf2's buffer. Frames without new transforms fade."""

    class_name = "rviz_default_plugins/TF"
    properties = (
        *Display.properties,
        Property("Show Names", False, flag),
        Property("Show Axes", True, flag),
        Property("Show Arrows", True, flag),
        Property("Marker Scale", 1.0, number()),
        Property("Update Interval", 0.0, number(0.0)),  # [s]
        Property("Frame Timeout", 15.0, number(1.0)),  # [s]
        Property("Filter (whitelist)", "", _regex),
        Property("Filter (blacklist)", "", _regex),
        Property(_ALL, True, flag),
        Property("Tree", {}, read_only),
    )

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._frames: dict[str, DrawnFrame] = {}
        self._latest: dict[str, _LatestTransform] = {}
        # The time of the last update; None requests an immediate one.
        self._updated_ns: int | None = None
        self._values["Tree"] = self._tree

    def on_property_change(self, label: str) -> None:
        """Enable or disable all frames or one. Other properties take effect in the next frame."""
        super().on_property_change(label)
        switches = [f"Frames/{frame}" for frame in self._frames]
        if label == _ALL:
            self._values |= dict.fromkeys(switches, self[_ALL])
        elif label in switches:
            self._values[_ALL] = self[_ALL] and self[label]
        self._updated_ns = None

    def reset(self) -> None:
        """Remove all frames."""
        super().reset()
        self.remove_properties("Frames")
        self._frames.clear()
        self._latest.clear()
        self._updated_ns = None

    def update(self) -> None:
        """Show all frames that pass the filters."""
        now_ns, last_ns = self.context.now_ns, self._updated_ns
        if last_ns is not None and now_ns - last_ns < self["Update Interval"] * NS:
            return
        self._updated_ns = now_ns
        whitelist, blacklist = self["Filter (whitelist)"], self["Filter (blacklist)"]
        names = [n for n in self.context.frames.buffer.frames() if _passes(n, whitelist, blacklist)]
        for name in self._frames.keys() - set(names):
            for node in self._frames.pop(name).nodes.values():
                self.context.scene.delete(node)
        # New frames get their properties in one call, because each call takes linear time.
        if new := [name for name in names if name not in self._frames]:
            self._frames |= {name: DrawnFrame(self.context.scene, self.path, name) for name in new}
            labels, rows = {prop.label for prop in self.properties}, list[Property]()
            for name in new:
                row, path = f"Frames/{name}", ("Frames", name)
                # A frame that was filtered out before has its properties already.
                if row not in labels:
                    rows.append(Property(row, True, flag, path))
                    for label in _FRAME_VALUES:
                        value = partial(self._frame_value, name, label)
                        rows.append(Property(f"{row}/{label}", value, read_only, (*path, label)))
            self.add_properties(*rows)
        for name in names:
            self._update(name)

    def _update(self, name: str) -> None:
        frames = self.context.frames
        drawn_frame, transform = self._frames[name], frames.transform(name)
        # The time since a frame received its transform, [s]; static transforms do not age.
        now_ns, latest = self.context.now_ns, self._latest.get(name)
        if latest is None or latest.transform is not transform:
            is_known = transform is not None
            stamp_ns = frames.buffer.lookup(frames.fixed_frame, name).stamp_ns if is_known else 0
            same = latest is not None and latest.stamp_ns == stamp_ns
            latest = self._latest[name] = _LatestTransform(
                transform, stamp_ns, latest.received_ns if latest and same else now_ns
            )
        age = (now_ns - latest.received_ns) / NS if latest.stamp_ns else 0.0
        look = Appearance(age / self["Frame Timeout"], self["Marker Scale"])
        if transform is None:
            self.statuses.set("warn", name, f"No transform from [{name}] to [{frames.fixed_frame}]")
        elif look.age <= 1:
            self.statuses.set("ok", name, "Transform OK")
        if transform is None or look.age > 1:
            drawn_frame.show(dict.fromkeys(PARTS, False), look)
            return
        parent = frames.buffer.parent(name)
        there = frames.transform(parent) if parent else None
        visible_parts = {part: self[f"Show {part.title()}"] and self[f"Frames/{name}"] for part in PARTS}
        visible_parts["arrows"] &= (
            there is not None and np.linalg.norm(there - transform, axis=0)[3] > _SHORTEST
        )
        drawn_frame.show(visible_parts, look)
        drawn_frame.place(transform, there, look.scale)

    def _frame_value(self, name: str, label: str) -> Any:
        """Return a value that RViz shows below a frame; quaternions are (x, y, z, w)."""
        frames = self.context.frames
        parent = frames.buffer.parent(name) or ""
        if label == "Parent":
            return parent
        if label.startswith("Relative"):
            return frames.pose_value(label, name, parent) if parent else ""
        return frames.pose_value(label, name)

    def _tree(self) -> dict[str, Any]:
        """Return each frame below its parent, as nested maps."""
        children: dict[str, dict[str, Any]] = {name: {} for name in self._frames}
        tree: dict[str, Any] = {}
        for name in self._frames:
            parent = self.context.frames.buffer.parent(name)
            children.get(parent or "", tree)[name] = children[name]
        return tree
