"""RViz's InteractiveMarkers display."""

from collections.abc import Iterable, Iterator
from math import isfinite
from typing import Any

import numpy as np

from course_lib.displays.display import Display, Interest, node_name
from course_lib.displays.interactive.client import LABEL, QOS, Actions, MarkerClient
from course_lib.displays.interactive.handles import MENU, Message
from course_lib.displays.interactive.marker import ShownControl, ShownMarker
from course_lib.displays.interactive.motion import Pointer, axes_of
from course_lib.displays.panel.controls import MenuItem, UseControl
from course_lib.displays.properties import Property, flag, text
from course_lib.errors import CourseError
from course_lib.viewer.camera import Camera

_COMMANDS = {1: "ros2 run", 2: "ros2 launch"}  # by the command_type of a menu's entry; 0 is feedback
_LEFT, _RIGHT = 0, 2  # buttons
_BOXES = {"[x]": "\u2611", "[ ]": "\u2610"}  # how RViz shows the beginning of a title


def namespace(value: Any) -> str:
    """Convert the namespace of a server; that of its topic of updates does, too."""
    return text(value).removesuffix("/update")


class InteractiveMarkersDisplay(Display):
    """The interactive markers of a server, which are dragged and clicked in a page."""

    class_name = "rviz_default_plugins/InteractiveMarkers"
    type_name = "visualization_msgs/msg/InteractiveMarkerUpdate"
    topic_label = "Interactive Markers Namespace"
    properties = (
        *Display.properties,
        Property(topic_label, "", namespace),
        Property("Show Descriptions", True, flag),
        Property("Show Axes", False, flag),
        Property("Show Visual Aids", False, flag),
        Property("Enable Transparency", True, flag),
    )

    acts = True

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self.markers: dict[str, ShownMarker] = {}
        self._client: MarkerClient | None = None

    @property
    def handles(self) -> str:
        """The node of the scene below which all markers are."""
        return f"{self.path}/handles"

    def start(self) -> None:
        """Connect to the server, if the display is ticked and knows its namespace."""
        self.interests, self._client = (), None
        super().start()
        if self.enabled:
            self._connect()

    def changed(self, label: str) -> None:
        """Connect again, or show and hide parts."""
        super().changed(label)
        if self.started and label in (self.topic_label, "Enable Transparency"):
            self.start()
        for marker in self.markers.values():
            self._show_parts(marker)

    def reset(self) -> None:
        """Forget all markers, and ask for them again."""
        super().reset()
        self.markers.clear()
        if self._client is not None:
            self._connect()

    def update(self) -> None:
        """Show what the server has sent, and follow frames and camera."""
        if self._client is not None:
            self._client.step()
        for marker in self.markers.values():
            marker.update()

    def look_from(self, camera: Camera) -> None:
        """Turn what faces the viewer."""
        for marker in self.markers.values():
            marker.update()

    def message_at(self, path: str) -> Message:
        """Return the interactive marker that an object was drawn from."""
        marker = self._marker_at(path)
        return None if marker is None else marker.message

    def use(self, order: UseControl) -> tuple[MenuItem, ...]:
        """Drag or click what a page's pointer is on; returns the menu that this opens, if any.

        What is not there any more is not used.
        """
        marker = self._marker_at(order.path)
        control = marker.control_at(order.path) if marker is not None else None
        if marker is None or control is None:
            return ()
        point = None if order.point is None else np.array(order.point)
        if order.button == _LEFT:
            _drag(marker, control, order)
        mode = control.message.interaction_mode
        is_asked = order.button == _RIGHT or (order.button == _LEFT and mode == MENU)
        if order.event != "up" or not is_asked:
            return ()
        marker.ask(control, point)
        return tuple(_items(marker.message.menu_entries))

    def show_only(self, path: str | None) -> None:
        """Hide all controls but the held one at a path and those that are always visible; None shows all."""
        for control in (control for marker in self.markers.values() for control in marker.controls):
            is_held = path is not None and f"{path}/".startswith(f"{control.path}/")
            is_shown = path is None or is_held or control.message.always_visible
            self.context.scene.set_visible(control.path, is_shown)
        for marker in self.markers.values():
            self._show_parts(marker)

    def choose(self, path: str, entry: int) -> str:
        """Choose an entry of the menu of the marker at a path; returns what there is to say about that."""
        marker = self._marker_at(path)
        entries = {} if marker is None else {one.id: one for one in marker.message.menu_entries}
        if marker is None or entry not in entries:
            raise CourseError("That entry is not in the menu any more.")
        chosen = entries[entry]
        if chosen.command_type in _COMMANDS:
            command = f"{_COMMANDS[chosen.command_type]} {chosen.command}"
            return f"RViz2 runs a command here. Run it in a cell: %{command}"
        marker.choose(entry)
        return ""

    def _connect(self) -> None:
        name = "/" + self[self.topic_label].strip("/")
        if name == "/":
            self.statuses.set("error", LABEL, "Error connecting: empty namespace")
            return
        actions = Actions(self._begin, self._follow, self._clear)
        transparent = self["Enable Transparency"]
        self._client = MarkerClient(self.context, name, self.statuses, actions, transparent)
        updates = f"{name}/update"
        self.interests = (Interest(updates, self.type_name, QOS, self._client.take, self.statuses),)
        self.context.joined(self.interests)

    def _marker_at(self, path: str) -> ShownMarker | None:
        return next((m for m in self.markers.values() if f"{path}/".startswith(f"{m.path}/")), None)

    def _clear(self) -> None:
        for name in list(self.markers):
            self._erase(name)

    def _begin(self, markers: Iterable[Message]) -> None:
        self._clear()
        self._show(markers)

    def _follow(self, update: Message) -> None:
        self._show(update.markers)
        self._move(update.poses)
        for name in update.erases:
            self._erase(name)

    def _erase(self, name: str) -> None:
        marker = self.markers.pop(name, None)
        self.statuses.delete(name)
        if marker is not None:
            self.context.scene.delete(marker.path)

    def _show(self, markers: Iterable[Message]) -> None:
        for message in markers:
            if not all(map(isfinite, _numbers(message))):
                self.statuses.set("error", message.name, "Marker contains invalid floats!")
            elif not message.controls:
                self._stop(f"the marker {message.name!r} has no controls.")
                self.statuses.set("ok", message.name, "Marker empty.")
                return
            else:
                self._marker(message.name).show(message)
                self._show_parts(self.markers[message.name])

    def _move(self, poses: Iterable[Message]) -> None:
        for message in poses:
            if not all(map(isfinite, _pose_numbers(message.pose))):
                self.statuses.set("error", message.name, "Pose message contains invalid floats!")
                return
            if message.name not in self.markers:
                self._stop(f"it knows no marker {message.name!r}.")
                said = f"Pose received for non-existing marker '{message.name}"  # RViz's, with one quote
                self.statuses.set("error", message.name, said)
                return
            self.markers[message.name].move(message.header, message.pose)

    def _stop(self, reason: str) -> None:
        if self._client is not None:
            self._client.stop(reason)

    def _marker(self, name: str) -> ShownMarker:
        """Return a marker by its name, new if there is none."""
        if name not in self.markers:
            path = f"{self.handles}/{node_name(name)}"
            self.markers[name] = ShownMarker(self.context, path, self.statuses, self._send)
        return self.markers[name]

    def _send(self, feedback: Message) -> None:
        if self._client is not None:
            self._client.send(feedback)

    def _show_parts(self, marker: ShownMarker) -> None:
        """Show what the properties ask for."""
        self.context.scene.set_visible(f"{marker.path}/axes", self["Show Axes"])
        self.context.scene.set_visible(f"{marker.path}/title", self["Show Descriptions"])
        marker.aids = self["Show Visual Aids"]


def _drag(marker: ShownMarker, control: ShownControl, order: UseControl) -> None:
    """Press, move or release a control with the left button."""
    point = None if order.point is None else np.array(order.point)
    if order.event == "down":
        marker.press(control, _pointer(order), point)
    elif order.event == "move":
        marker.drag(_pointer(order), order.shift, order.ctrl)
    else:
        marker.release(control, point)


def _pointer(order: UseControl) -> Pointer:
    """Return the pointer of an order, in the fixed frame."""
    direction = np.array(order.direction)
    if not direction.any() or order.pixel <= 0:
        raise CourseError(f"The page's ray {order.direction} with pixels of {order.pixel} m points nowhere.")
    return Pointer(
        origin=np.array(order.origin),
        direction=direction / np.linalg.norm(direction),
        axes=axes_of(Camera(order.eye, order.target, order.up)),
        pixel=order.pixel,
        flat=bool(order.scale),
    )


def _items(entries: Iterable[Message]) -> Iterator[MenuItem]:
    """Yield the entries of a menu, each before those that it opens."""
    entries = list(entries)
    known = {0}
    parents = {entry.parent_id for entry in entries}

    def below(parent: int, depth: int) -> Iterator[MenuItem]:
        for entry in (entry for entry in entries if entry.parent_id == parent and entry.id not in known):
            known.add(entry.id)
            box, words = _BOXES.get(entry.title[:3], ""), entry.title
            shown = f"{box}{words[3:]}" if box else f"\u3000{words}"
            yield MenuItem(entry.id, "\u3000" * depth + shown, entry.id in parents)
            yield from below(entry.id, depth + 1)

    return below(0, 0)


def _pose_numbers(pose: Message) -> tuple[float, ...]:
    p, q = pose.position, pose.orientation
    return p.x, p.y, p.z, q.x, q.y, q.z, q.w


def _numbers(message: Message) -> Iterator[float]:
    """Yield the numbers of an interactive marker that RViz checks."""
    yield from (*_pose_numbers(message.pose), message.scale)
    for control in message.controls:
        q = control.orientation
        yield from (q.x, q.y, q.z, q.w)
        for part in control.markers:
            s, c = part.scale, part.color
            yield from (*_pose_numbers(part.pose), s.x, s.y, s.z, c.r, c.g, c.b, c.a)
            for point in part.points:
                yield from (point.x, point.y, point.z)
