"""The TF display."""

import re
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from course_lib.displays.display import Display
from course_lib.displays.frames import NS, Matrix
from course_lib.displays.properties import Property, flag, number, read_only, text
from course_lib.displays.tf.frame import PARTS, DrawnFrame, Look
from course_lib.ros.tf2_errors import TransformException

_ALL = "Frames/All Enabled"
_SHORTEST = 0.001  # [m]; an arrow up to this is not drawn
_MEASURED = ("Parent", "Position", "Orientation", "Relative Position", "Relative Orientation")


def _regex(value: Any) -> str:
    """Take a regular expression."""
    try:
        re.compile(text(value))
    except re.error as error:
        raise ValueError(f"a regular expression; {error}") from None
    return text(value)


class _Heard(NamedTuple):
    """When a frame got the transform to the fixed frame that it has."""

    transform: Matrix | None
    stamp_ns: int  # 0 if it never changes, or is not known
    came_ns: int


class TfDisplay(Display):
    """Shows the frames that tf2 knows, and fades those that nobody publishes any more."""

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
