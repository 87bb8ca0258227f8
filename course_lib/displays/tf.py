"""RViz's TF display."""

import re
from collections.abc import Mapping
from functools import partial
from math import floor
from typing import Any, NamedTuple

import numpy as np

from course_lib.arrays import Matrix
from course_lib.displays.display import Display, node_name
from course_lib.displays.frames import NS
from course_lib.displays.marker.drawables import placement, turned_to
from course_lib.displays.properties import Property, flag, number, read_only, text
from course_lib.displays.reference_display import AXIS_COLORS, axes
from course_lib.ros.tf2_transform import TransformException
from course_lib.viewer.drawables import Solids, Text
from course_lib.viewer.scene import Scene

PARTS = ("axes", "arrows", "names")  # the nodes that all frames have theirs below

_LENGTH, _WIDTH = 0.2, 0.02  # [m] of an axis
_SHAFT, _HEAD, _HEAD_LENGTH = 0.01, 0.04, 0.1  # [m] diameters, and the head's length
_SHAFT_COLOR, _HEAD_COLOR = np.array([0.8, 0.8, 0.3, 1.0]), np.array([1.0, 0.1, 0.6, 1.0])
_NAME_HEIGHT = 0.1  # [m]
_WHITE = np.ones(4)
_GREY = np.array([0.7, 0.7, 0.7, 1.0])
_STEPS = 48  # of fading, within the timeout
_ALL = "Frames/All Enabled"
_SHORTEST = 0.001  # [m]; an arrow up to this is not drawn
_MEASURED = ("Parent", "Position", "Orientation", "Relative Position", "Relative Orientation")


class Look(NamedTuple):
    """The picture of a frame."""

    age: float  # since its last transform, in timeouts; it goes grey from 1/3 to 2/3, and fades until 1
    scale: float  # Marker Scale


class DrawnFrame:
    """Axes, name and an arrow to the parent; what is not to be seen is not even made."""

    def __init__(self, scene: Scene, path: str, frame: str) -> None:
        self._scene = scene
        self._frame = frame
        self.nodes = {part: f"{path}/{part}/{node_name(frame)}" for part in PARTS}
        self._made: dict[str, Look] = {}
        self._shown: dict[str, bool] = {}
        self._placed: tuple[Matrix | None, Matrix | None] = (None, None)

    def show(self, wanted: Mapping[str, bool], look: Look) -> None:
        """Show some parts of it and hide the others."""
        look = Look(max(floor(look.age * _STEPS) / _STEPS, 1 / 3), look.scale)
        for part in PARTS:
            if wanted[part] and self._made.get(part) != look:
                self._made[part] = look
                self._placed = (None, None)
                self._draw(part, look)
            if part in self._made and self._shown.get(part, True) != wanted[part]:
                self._shown[part] = wanted[part]
                self._scene.set_visible(self.nodes[part], wanted[part])

    def place(self, transform: Matrix, transform_parent: Matrix | None, scale: float) -> None:
        """Move it; both transforms lead to the fixed frame."""
        before, before_parent = self._placed
        if before is transform and before_parent is transform_parent:
            return
        self._placed = (transform, transform_parent)
        for part in self._made.keys() - {"arrows"}:
            self._scene.set_transform(self.nodes[part], transform)
        if "arrows" in self._made and transform_parent is not None:
            self._place_arrow(transform[:3, 3], transform_parent[:3, 3], scale)

    def _draw(self, part: str, look: Look) -> None:
        put, node = self._scene.set_object, self.nodes[part]
        if part == "axes":
            put(node, axes(look.scale * _LENGTH, look.scale * _WIDTH, _faded(AXIS_COLORS, look.age)))
        elif part == "names":
            height = look.scale * _NAME_HEIGHT
            put(node, Text(self._frame, height, _faded(_WHITE, look.age), below=True))
        else:
            put(f"{node}/shaft", Solids("cylinder", [np.eye(4)], _faded(_SHAFT_COLOR, look.age)))
            put(f"{node}/head", Solids("cone", [np.eye(4)], _faded(_HEAD_COLOR, look.age)))

    def _place_arrow(self, start: Matrix, end: Matrix, scale: float) -> None:
        length = float(np.linalg.norm(end - start))
        if not length:
            return
        direction = (end - start) / length
        head = _HEAD_LENGTH * scale * (length if length < _HEAD_LENGTH * scale else 1.0)  # as in RViz
        turned, node = turned_to(direction), self.nodes["arrows"]
        sizes = ((_SHAFT * scale, length - head), (_HEAD * scale, head))
        centers = ((length - head) / 2, length - head / 2)
        for part, (width, along), center in zip(("shaft", "head"), sizes, centers, strict=True):
            placed = placement(turned, (width, width, along), start + direction * center)
            self._scene.set_transform(f"{node}/{part}", placed)


def _faded(color: Matrix, age: float) -> Matrix:
    """Return RGBA after an age in timeouts."""
    if age <= 2 / 3:
        share = 2 - 3 * age
        faded: Matrix = share * color + (1 - share) * _GREY
        return faded
    fading: Matrix = np.broadcast_to(_GREY * [1, 1, 1, max(0.0, 3 - 3 * age)], color.shape)
    return fading


def _regex(value: Any) -> str:
    """Convert a regular expression."""
    try:
        re.compile(text(value))
    except re.error as error:
        raise ValueError(f"a regular expression; {error}") from None
    return text(value)


class _Heard(NamedTuple):
    """The latest transform of a frame to the fixed frame, and the time of its arrival."""

    transform: Matrix | None
    stamp_ns: int  # 0 if it never changes, or is not known
    came_ns: int


class TfDisplay(Display):
    """The frames that tf2 knows; those without new transforms fade."""

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
        self._heard: dict[str, _Heard] = {}
        self._updated_ns: int | None = None  # None asks for an update now
        self._values["Tree"] = self._tree

    def __getitem__(self, label: str) -> Any:
        """Return a property; what is measured is so now."""
        value = super().__getitem__(label)
        return value() if callable(value) else value

    def changed(self, label: str) -> None:
        """Tick all frames or one; all else counts from the next frame on."""
        super().changed(label)
        switches = [f"Frames/{frame}" for frame in self._frames]
        if label == _ALL:
            self._values |= dict.fromkeys(switches, self[_ALL])
        elif label in switches:
            self._values[_ALL] = self[_ALL] and self[label]
        self._updated_ns = None

    def reset(self) -> None:
        """Forget all frames."""
        super().reset()
        self.shrink("Frames")
        self._frames.clear()
        self._heard.clear()
        self._updated_ns = None

    def update(self) -> None:
        """Show all frames that pass the filters."""
        now_ns, last_ns = self.context.now_ns, self._updated_ns
        if last_ns is not None and now_ns - last_ns < self["Update Interval"] * NS:
            return
        self._updated_ns = now_ns
        wanted, unwanted = self["Filter (whitelist)"], self["Filter (blacklist)"]
        names = [name for name in self.context.frames.buffer.frames() if re.search(wanted, name)]
        names = [name for name in names if not (unwanted and re.search(unwanted, name))]
        for name in self._frames.keys() - set(names):
            for node in self._frames.pop(name).nodes.values():
                self.context.scene.delete(node)
        for name in names:
            self._update(name)

    def _update(self, name: str) -> None:
        frames = self.context.frames
        if name not in self._frames:
            self._frames[name] = DrawnFrame(self.context.scene, self.path, name)
            self._grow(name)
        drawn, transform = self._frames[name], frames.transform(name)
        look = Look(self._age(name, transform) / self["Frame Timeout"], self["Marker Scale"])
        if transform is None:
            self.statuses.set("warn", name, f"No transform from [{name}] to [{frames.fixed_frame}]")
        elif look.age <= 1:
            self.statuses.set("ok", name, "Transform OK")
        if transform is None or look.age > 1:
            drawn.show(dict.fromkeys(PARTS, False), look)
            return
        parent = frames.buffer.parent(name)
        there = frames.transform(parent) if parent else None
        wanted = {part: self[f"Show {part.title()}"] and self[f"Frames/{name}"] for part in PARTS}
        wanted["arrows"] &= there is not None and np.linalg.norm(there - transform, axis=0)[3] > _SHORTEST
        drawn.show(wanted, look)
        drawn.place(transform, there, look.scale)

    def _grow(self, name: str) -> None:
        here, names = f"Frames/{name}", ("Frames", name)
        if any(prop.label == here for prop in self.properties):
            return  # it had been filtered out
        measured = (
            Property(f"{here}/{label}", partial(self._measured, name, label), read_only, (*names, label))
            for label in _MEASURED
        )
        self.grow(Property(here, True, flag, names), *measured)

    def _age(self, name: str, transform: Matrix | None) -> float:
        """Return how long ago a frame got its transform to the fixed frame, [s]; static ones stay new."""
        now_ns, frames, heard = self.context.now_ns, self.context.frames, self._heard.get(name)
        if heard is None or heard.transform is not transform:
            known = transform is not None
            stamp_ns = frames.buffer.lookup(frames.fixed_frame, name).stamp_ns if known else 0
            same = heard is not None and heard.stamp_ns == stamp_ns
            heard = self._heard[name] = _Heard(
                transform, stamp_ns, heard.came_ns if heard and same else now_ns
            )
        return (now_ns - heard.came_ns) / NS if heard.stamp_ns else 0.0

    def _measured(self, name: str, what: str) -> Any:
        """Return what RViz shows below a frame; quaternions as (x, y, z, w)."""
        frames = self.context.frames
        parent = frames.buffer.parent(name) or ""
        if what == "Parent":
            return parent
        try:
            target = parent if what.startswith("Relative") else frames.fixed_frame
            transform = frames.buffer.lookup(target, name)
        except TransformException:
            return ""
        numbers = transform.translation if what.endswith("Position") else transform.rotation
        return tuple(round(number, 6) for number in numbers)

    def _tree(self) -> dict[str, Any]:
        """Return each frame below its parent, as nested maps."""
        children: dict[str, dict[str, Any]] = {name: {} for name in self._frames}
        tree: dict[str, Any] = {}
        for name in self._frames:
            parent = self.context.frames.buffer.parent(name)
            children.get(parent or "", tree)[name] = children[name]
        return tree
