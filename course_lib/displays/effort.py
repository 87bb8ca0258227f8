"""RViz's Effort display."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np
from transforms3d.axangles import axangle2mat

from course_lib.arrays import Floats, Matrix
from course_lib.displays.clouds.cloud import rainbow
from course_lib.displays.display import Interest, node_name
from course_lib.displays.frames import nanoseconds
from course_lib.displays.marker.drawables import ALONG_MINUS_X, ALONG_X, placement
from course_lib.displays.properties import Property, flag, integer, number, read_only, text
from course_lib.displays.topic_display import DrawnDisplay
from course_lib.errors import CourseError
from course_lib.robots.urdf import Joint, parse_urdf
from course_lib.ros.qos import Qos
from course_lib.viewer.drawables import Drawable, Lines, Solids

_SMALLEST = 0.05  # of the radius, [m], and of the share of the limit
_ANGLES = np.arange(30) * 2 * np.pi / 32  # of the points of the circle; its arrow fills the gap
_NO_LIMIT = (
    "Joint '{}' has no <limit> tag in URDF. Effort plugin needs to know the effort limit to determine the "
    "size of the corresponding visual marker. Effort display for this joint will be inhibited."
)
_MIXED = "Received a joint state msg with different joint names and efforts size!"


@dataclass(frozen=True, eq=False)
class _Turning:
    """An effort about the z axis of a frame; the transform's shape is (4, 4)."""

    effort: float  # [N m]
    limit: float  # [N m]
    transform_to_fixed: Matrix

    @property
    def share(self) -> float:
        """The share of the limit, if there is one, and a little more."""
        return (min(abs(self.effort) / self.limit, 1.0) if self.limit else abs(self.effort)) + _SMALLEST

    def circle(self, scale: float) -> Floats:
        """Return the points of the circle in the fixed frame, shape (30, 3)."""
        side = -1 if self.effort < 0 else 1
        points = np.column_stack([side * np.sin(_ANGLES), np.cos(_ANGLES), 0 * _ANGLES]) * self._radius(scale)
        moved: Floats = points @ self.transform_to_fixed[:3, :3].T + self.transform_to_fixed[:3, 3]
        return moved

    def tip(self, scale: float, width: float) -> Matrix:
        """Return the placement of the arrow's head, shape (4, 4)."""
        along, side = (ALONG_MINUS_X, -1) if self.effort > 0 else (ALONG_X, 1)
        center = (side * width, self._radius(scale), 0.0)
        placed: Matrix = self.transform_to_fixed @ placement(along, (4 * width, 4 * width, 2 * width), center)
        return placed

    def _radius(self, scale: float) -> float:
        return _SMALLEST + self.share * scale / 2


class EffortDisplay(DrawnDisplay):
    """Efforts of revolute joints as arrows that turn about their axes, larger and redder near the limit."""

    class_name = "rviz_default_plugins/Effort"
    type_name = "sensor_msgs/msg/JointState"
    length_label = "History Length"
    properties = (
        *DrawnDisplay.properties,
        Property("Alpha", 1.0, number()),
        Property("Width", 0.02, number()),  # [m]
        Property("Scale", 1.0, number()),  # [m] of the diameter at the limit
        Property("History Length", 1, integer(1, 100_000)),
        Property("Robot Description", "/robot_description", text),
        Property("TF Prefix", "", text),
    )

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        self._joints: dict[str, Joint] | None = None  # those that turn and have a limit, by name

    def changed(self, label: str) -> None:
        """Read another description, or redraw."""
        super().changed(label)
        if label == "Robot Description" and self.started:
            self.start()

    def wanted(self) -> tuple[Interest, ...]:
        """Listen to the description, too."""
        latched = Qos(depth=1, durability="transient_local")
        topic = self["Robot Description"]
        return *super().wanted(), self.interest(topic, "std_msgs/msg/String", self._describe, latched)

    def start(self) -> None:
        """Forget the robot, and listen."""
        self._joints = None
        self.shrink("Joints")
        super().start()

    def process(self, message: Any) -> None:
        """Show the efforts of joint states; joints that a message lacks stay as they were."""
        if self._joints is None:
            self.statuses.set("error", "Process message", "Robot model might not be loaded yet")
            return
        self.statuses.delete("Process message")
        oldest = self.kept.popleft() if len(self.kept) == self.kept.maxlen else {}
        if len(message.name) != len(message.effort):
            self.statuses.set("error", "Topic", _MIXED)
            self.draw()
            return
        stamp_ns = nanoseconds(message.header.stamp)
        efforts = dict(zip(message.name, map(float, message.effort), strict=True))
        shown = {name: self._turning(name, effort, stamp_ns) for name, effort in efforts.items()}
        self.keep({**oldest, **{name: turning for name, turning in shown.items() if turning}})

    def parts(self) -> Mapping[str, Drawable]:
        """Return circles and arrows of the joints that are ticked."""
        width, scale = self["Width"], self["Scale"]
        parts: dict[str, Drawable] = {}
        for number_, turnings in enumerate(self.kept):
            for name in (name for name in turnings if self[f"Joints/{name}"]):
                rgba = (*rainbow([turnings[name].share])[0], 1.0)
                node = f"{number_} {node_name(name)}"
                parts[f"{node} circle"] = Lines(turnings[name].circle(scale), rgba, width)
                parts[f"{node} tip"] = Solids("cone", [turnings[name].tip(scale, width)], rgba)
        return parts

    def _describe(self, message: Any) -> None:
        """Read the joints of a robot description."""
        try:
            robot = parse_urdf(message.data)
        except CourseError as error:
            self.statuses.set("error", "URDF", "Unable to parse robot model description!")
            self.statuses.hint("URDF", str(error))
            return
        self.statuses.set("ok", "URDF", "Robot model parsed Ok")
        turning = {
            name: joint for name, joint in robot.joints.items() if joint.kind in ("revolute", "continuous")
        }
        lacking = [_NO_LIMIT.format(name) for name, joint in turning.items() if joint.effort is None]
        self.statuses.hint("URDF", *(f"RViz's log: {text}" for text in lacking))
        self._joints = {name: turning[name] for name in sorted(turning) if turning[name].effort is not None}
        self.grow(*(prop for joint in self._joints.values() for prop in _properties(joint)))

    def _turning(self, name: str, effort: float, stamp_ns: int) -> _Turning | None:
        """Return the picture of a joint's effort, unless RViz does not draw it."""
        joint = (self._joints or {}).get(name)
        if joint is None or joint.effort is None:
            return None
        self._values[f"Joints/{name}/Effort"] = effort
        if joint.kind != "revolute":
            return None
        prefix, frames = self["TF Prefix"], self.context.frames
        frame = f"{prefix}/{joint.child}" if prefix else joint.child
        transform = frames.transform(frame, stamp_ns)
        if transform is None:
            problem = f"Error transforming from frame '{frame}' to frame '{frames.fixed_frame}'"
            self.statuses.set("error", name, problem)
            return None
        if not isfinite(effort):
            self.statuses.set("error", name, f"Invalid effort: {effort}")
            return None
        self.statuses.set("ok", name, "")
        return _Turning(effort, joint.effort, transform @ _axis_to_z(joint.axis))


def _properties(joint: Joint) -> tuple[Property, ...]:
    here, names = f"Joints/{joint.name}", ("Joints", joint.name)
    return (
        Property(here, True, flag, names),
        Property(f"{here}/Effort", 0.0, read_only, (*names, "Effort")),
        Property(f"{here}/Max Effort", joint.effort, read_only, (*names, "Max Effort")),
    )


def _axis_to_z(axis: tuple[float, ...]) -> Matrix:
    """Return the turn that RViz puts behind a joint's frame, shape (4, 4).

    It takes the axis to z, and not z to the axis, so an axis that is not along x, y or z is not met.
    """
    turn, normal = np.eye(4), np.cross(axis, (0.0, 0.0, 1.0))
    if normal.any():
        angle = np.arccos(axis[2] / np.linalg.norm(axis))
        turn[:3, :3] = axangle2mat(normal, angle)
    return turn
