"""Displays that are a table of properties and the conversion of one message type to drawables.

RViz's PoseStamped, PoseWithCovariance, PoseArray, Odometry, Path, Polygon, PointStamped, Range,
Wrench, TwistStamped, AccelStamped, Effort and GridCells. `DrawnDisplay` does the rest: it
subscribes, waits for transforms, keeps messages, redraws after a change, and sets RViz's statuses.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import atan2, isfinite, isinf, tan
from typing import Any, ClassVar

import numpy as np
from transforms3d.axangles import axangle2mat

from course_lib.arrays import Floats, Matrix
from course_lib.displays.clouds import rainbow
from course_lib.displays.display import INVALID, DrawnDisplay, Subscription, node_name
from course_lib.displays.frames import is_unit, nanoseconds, pose_in_fixed_frame
from course_lib.displays.properties import (
    Property,
    color,
    flag,
    integer,
    number,
    read_only,
    text,
    vector,
    words,
)
from course_lib.displays.shapes import (
    ALONG_MINUS_X,
    ALONG_X,
    COVARIANCE_PROPERTIES,
    UncertainPose,
    alpha_drawn_twice,
    draw_arrows,
    draw_axes,
    draw_covariances,
    draw_shapes,
    placement,
    points_of,
    pose_matrices,
    pose_numbers,
    rgba_of,
    rotation_to,
    shape_properties,
    uncertain_pose,
)
from course_lib.errors import CourseError
from course_lib.robots.urdf import Joint, parse_urdf
from course_lib.ros.graph.topics import Qos
from course_lib.viewer.drawables import Drawable, Lines, Points, Solids

_FLAT, _SOLID = "Arrow (Flat)", "Arrow (3D)"
# A flat arrow of length 1 as three lines: the shaft and both sides of the head
# (flat_arrows_array.cpp).
_STROKES = np.array([(0, 0, 0), (1, 0, 0), (1, 0, 0), (0.75, 0.2, 0), (1, 0, 0), (0.75, -0.2, 0)])
_NOT_UNIT = "Message contained unnormalized quaternion (squares of values don't add to 1)"
_NOT_UNIT_HINT = (
    "{} not have length 1, ({}): RViz2 may draw a wrong rotation. Divide a quaternion by its length."
)
# Tolerance of a quaternion's squared length, as for markers.
_UNIT_TOLERANCE = 1e-3
_ARROW = ("Shaft Length", "Shaft Diameter", "Head Length", "Head Diameter")
# The properties of an arrow in the panel's order.
_ARROW_ROWS = ("Shaft Length", "Head Length", "Shaft Diameter", "Head Diameter")
# Conditions of a path's properties.
_AXES, _ARROWS = (("Pose Style", "Axes"),), (("Pose Style", "Arrows"),)


def hint_orientations(display: DrawnDisplay, poses: Matrix) -> None:
    """Add a hint if quaternions of poses, shape (N, 7), do not have length 1, or remove it.

    RViz normalizes some of them and not others, without a status.
    """
    wrong = np.abs((poses[:, 3:] ** 2).sum(axis=1) - 1.0) > _UNIT_TOLERANCE
    if wrong.any():
        quaternion = ", ".join(f"{number:g}" for number in poses[wrong][0, 3:])
        subject = "orientation does"
        if len(poses) > 1:
            subject = f"{wrong.sum()} of {len(poses)} orientations do"
        display.statuses.hint("Orientation", _NOT_UNIT_HINT.format(subject, quaternion))
    else:
        display.statuses.hint("Orientation")


class PoseDisplay(DrawnDisplay):
    """The last pose, as an arrow or as axes."""

    class_name = "rviz_default_plugins/Pose"
    type_name = "geometry_msgs/msg/PoseStamped"
    properties = (*DrawnDisplay.properties, *shape_properties())

    def numbers(self, message: Any) -> Matrix:
        """Return position and quaternion."""
        return pose_numbers([message.pose])

    def convert(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix:
        """Return the pose in the fixed frame, shape (4, 4)."""
        hint_orientations(self, self.numbers(message))
        return pose_in_fixed_frame(transform_frame_to_fixed, message.pose)

    def drawables(self) -> Mapping[str, Drawable]:
        """Return an arrow or axes at the pose."""
        return draw_shapes(list(self.history), self) if self.history else {}


class PoseWithCovarianceDisplay(DrawnDisplay):
    """The last pose and its covariance."""

    class_name = "rviz_default_plugins/PoseWithCovariance"
    type_name = "geometry_msgs/msg/PoseWithCovarianceStamped"
    properties = (*PoseDisplay.properties, *COVARIANCE_PROPERTIES)
    # Label prefix of the shape's properties.
    shape_prefix: ClassVar[str] = ""

    def numbers(self, message: Any) -> Matrix:
        """Return pose and covariance."""
        return np.append(pose_numbers([message.pose.pose]), message.pose.covariance)

    def convert(self, message: Any, transform_frame_to_fixed: Matrix) -> UncertainPose:
        """Return the pose in the fixed frame, with its covariance."""
        hint_orientations(self, pose_numbers([message.pose.pose]))
        return uncertain_pose(message.pose, transform_frame_to_fixed)

    def drawables(self) -> Mapping[str, Drawable]:
        """Return arrows or axes at the poses, and their covariances."""
        if not self.history:
            return {}
        shapes = draw_shapes([message.pose for message in self.history], self, self.shape_prefix)
        return shapes | draw_covariances(list(self.history), self)


class PoseArrayDisplay(DrawnDisplay):
    """The poses of the last message, as flat arrows, solid arrows, or axes."""

    class_name = "rviz_default_plugins/PoseArray"
    type_name = "geometry_msgs/msg/PoseArray"
    is_in_message_frame = True
    properties = (
        *DrawnDisplay.properties,
        Property("Shape", _FLAT, words(_FLAT, _SOLID, "Axes")),
        Property("Color", (255, 25, 0), color, shown_if=(("Shape", _FLAT, _SOLID),)),
        Property("Alpha", 1.0, number(0.0, 1.0), shown_if=(("Shape", _FLAT, _SOLID),)),
        Property("Arrow Length", 0.3, number(), shown_if=(("Shape", _FLAT),)),  # [m]
        # RViz's names for the diameters [m].
        Property("Head Radius", 0.03, number(), shown_if=(("Shape", _SOLID),)),
        Property("Head Length", 0.07, number(), shown_if=(("Shape", _SOLID),)),
        Property("Shaft Radius", 0.01, number(), shown_if=(("Shape", _SOLID),)),
        Property("Shaft Length", 0.23, number(), shown_if=(("Shape", _SOLID),)),
        Property("Axes Length", 0.3, number(), shown_if=(("Shape", "Axes"),)),
        Property("Axes Radius", 0.01, number(), shown_if=(("Shape", "Axes"),)),
    )

    def numbers(self, message: Any) -> Matrix:
        """Return positions and quaternions, shape (N, 7)."""
        return pose_numbers(message.poses)

    def convert(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix:
        """Return positions and quaternions, shape (N, 7)."""
        poses = self.numbers(message)
        hint_orientations(self, poses)
        return poses

    def drawables(self) -> Mapping[str, Drawable]:
        """Return all arrows or axes as one drawable, in the frame of the message."""
        if not self.history or not len(self.history[0]):
            return {}
        if self["Shape"] != _FLAT:
            return draw_shapes(pose_matrices(self.history[0]), self)
        poses = pose_matrices(self.history[0], is_raw=True)
        points = (poses[:, None, :3, :3] @ (_STROKES * self["Arrow Length"])[:, :, None])[..., 0]
        ends = (points + poses[:, None, :3, 3]).reshape(-1, 3)
        return {"arrows": Lines(ends, rgba_of(self), strip=False)}


class OdometryDisplay(PoseWithCovarianceDisplay):
    """The poses of a moving robot, one for each step that it has moved or turned."""

    class_name = "rviz_default_plugins/Odometry"
    type_name = "nav_msgs/msg/Odometry"
    length_label = "Keep"
    shape_prefix = "Shape/"
    properties = (
        *DrawnDisplay.properties,
        # Step in position [m].
        Property("Position Tolerance", 0.1, number(0.0)),
        # Step in orientation [rad].
        Property("Angle Tolerance", 0.1, number(0.0)),
        Property("Keep", 100, integer(0)),
        *shape_properties(below="Shape/"),
        *COVARIANCE_PROPERTIES,
    )
    # Position and quaternion (x, y, z, w) of the last step, shape (7,).
    _last: Matrix | None = None

    def reset(self) -> None:
        """Discard all poses."""
        super().reset()
        self._last = None

    def process(self, message: Any) -> None:
        """Show a pose if it is far enough from the last displayed one."""
        (pose,) = pose_numbers([message.pose.pose])
        # This is the only display of RViz that rejects quaternions without unit length.
        if not is_unit(message.pose.pose.orientation, 10e-3):
            self.statuses.set("error", "Topic", _NOT_UNIT)
            return
        if self._last is not None and np.isfinite(self.numbers(message)).all():
            first, second = self._last[3:], pose[3:]
            turn = np.cross(second[:3], first[:3]) + second[3] * first[:3] - first[3] * second[:3]
            angle = 2 * atan2(np.linalg.norm(turn), abs(first @ second))
            distance = np.linalg.norm(self._last[:3] - pose[:3])
            if distance < self["Position Tolerance"] and angle < self["Angle Tolerance"]:
                return
        super().process(message)

    def convert(self, message: Any, transform_frame_to_fixed: Matrix) -> UncertainPose:
        """Return the pose in the fixed frame, with its covariance, and remember it as the last step."""
        (self._last,) = pose_numbers([message.pose.pose])
        return super().convert(message, transform_frame_to_fixed)


class PathDisplay(DrawnDisplay):
    """The last paths as lines, and optionally axes or arrows at their poses.

    The frame is taken from the header of the path. Like RViz, it ignores the headers of the poses.
    """

    class_name = "rviz_default_plugins/Path"
    type_name = "nav_msgs/msg/Path"
    length_label = "Buffer Length"
    properties = (
        *DrawnDisplay.properties,
        Property("Line Style", "Lines", words("Lines", "Billboards")),
        # Width of Billboards [m]; Lines are one pixel wide.
        Property("Line Width", 0.03, number(0.001), shown_if=(("Line Style", "Billboards"),)),
        Property("Color", (25, 255, 0), color),
        Property("Alpha", 1.0, number()),
        Property("Buffer Length", 1, integer(1)),
        Property("Offset", (0.0, 0.0, 0.0), vector),  # [m], in the fixed frame
        Property("Pose Style", "None", words("None", "Axes", "Arrows")),
        # Length of the axes [m].
        Property("Length", 0.3, number(), shown_if=_AXES),
        # RViz's name for the diameter of the axes [m].
        Property("Radius", 0.03, number(), shown_if=_AXES),
        # The color of the arrows.
        Property("Pose Color", (255, 85, 255), color, shown_if=_ARROWS),
        *(
            Property(label, size, number(), shown_if=_ARROWS)
            for label, size in zip(_ARROW_ROWS, (0.1, 0.2, 0.1, 0.3), strict=True)
        ),
    )

    def process(self, message: Any) -> None:
        """Keep the poses, shape (N, 7), with the transform of their frame.

        An invalid path replaces the previous one, too.
        """
        path = (np.eye(4), np.empty((0, 7)))
        numbers = pose_numbers([stamped.pose for stamped in message.poses])
        if not np.isfinite(numbers).all():
            self.statuses.set("error", "Topic", INVALID)
        elif (transform := self.transform_at(message.header)) is not None:
            path = (transform, numbers)
            # The orientations have no effect in a line.
            hint_orientations(self, numbers[: len(numbers) * (self["Pose Style"] != "None")])
        self.keep(path)

    def drawables(self) -> Mapping[str, Drawable]:
        """Return a line for each path, and the axes or arrows at all poses."""
        offset = np.eye(4)
        offset[:3, 3] = self["Offset"]
        history = [(transform, numbers) for transform, numbers in self.history if len(numbers)]
        paths = [(offset @ transform, numbers) for transform, numbers in history]
        width = self["Line Width"] if self["Line Style"] == "Billboards" else 0.0
        drawables: dict[str, Drawable] = {}
        for i, (transform, numbers) in enumerate(paths):
            points = numbers[:, :3] @ transform[:3, :3].T + transform[:3, 3]
            drawables[f"line {i}"] = Lines(points, rgba_of(self), width)
        if paths and self["Pose Style"] == "Axes":
            poses = [transform @ pose_matrices(numbers) for transform, numbers in paths]
            drawables |= draw_axes(np.concatenate(poses), self["Length"], self["Radius"])
        elif paths and self["Pose Style"] == "Arrows":
            poses = []
            for transform, numbers in paths:
                # RViz points an arrow along the product of quaternion and x, even if the quaternion
                # has another length than 1. This is a wrong direction, which this code reproduces.
                ahead = pose_matrices(numbers, is_raw=True)[:, :3, 0]
                x, y, z = (ahead / np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-12)).T
                # The shortest turn from x to the direction; the opposite direction is half a turn
                # about z.
                turns = np.column_stack([0 * x, -z, y, 1 + x])
                turns[x < -1 + 1e-9] = (0.0, 0.0, 1.0, 0.0)
                poses.append(transform @ pose_matrices(np.hstack([numbers[:, :3], turns])))
            rgb = [channel / 255 for channel in self["Pose Color"]]
            sizes = (self[label] for label in _ARROW)
            drawables |= draw_arrows(np.concatenate(poses), *sizes, rgba=(*rgb, 1.0))
        return drawables


class PolygonDisplay(DrawnDisplay):
    """The last polygon, as a closed line."""

    class_name = "rviz_default_plugins/Polygon"
    type_name = "geometry_msgs/msg/PolygonStamped"
    is_in_message_frame = True
    properties = (
        *DrawnDisplay.properties,
        Property("Color", (25, 255, 0), color),
        Property("Alpha", 1.0, number(0.0, 1.0)),
    )

    def numbers(self, message: Any) -> Matrix:
        """Return the corners, shape (N, 3), [m]."""
        return points_of(message.polygon)

    def drawables(self) -> Mapping[str, Drawable]:
        """Return the line through all corners and back to the first one."""
        if not self.history or not len(self.history[0]):
            return {}
        (corners,) = self.history
        return {"line": Lines(np.vstack([corners, corners[:1]]), rgba_of(self))}


class PointStampedDisplay(DrawnDisplay):
    """The last points as spheres, all in the frame of the last one, as in RViz."""

    class_name = "rviz_default_plugins/PointStamped"
    type_name = "geometry_msgs/msg/PointStamped"
    length_label, is_in_message_frame = "History Length", True
    properties = (
        *DrawnDisplay.properties,
        Property("Color", (204, 41, 204), color),
        Property("Alpha", 1.0, number()),
        # RViz's name for the diameter [m].
        Property("Radius", 0.2, number()),
        Property("History Length", 1, integer(1, 100_000)),
    )

    def numbers(self, message: Any) -> Matrix:
        """Return the point, shape (3,), [m]."""
        return np.array([message.point.x, message.point.y, message.point.z])

    def drawables(self) -> Mapping[str, Drawable]:
        """Return all spheres as one drawable."""
        balls = [placement(np.eye(3), self["Radius"], point) for point in self.history]
        return {"points": Solids("sphere", balls, rgba_of(self))} if balls else {}


# Fraction of the range by which RViz shifts its cone model.
_RANGE_OFFSET = 0.008824


class RangeDisplay(DrawnDisplay):
    """The last measurements of a range finder, as cones along +x of the measured length."""

    class_name = "rviz_default_plugins/Range"
    type_name = "sensor_msgs/msg/Range"
    properties = (
        *DrawnDisplay.properties,
        Property("Color", (255, 255, 255), color),
        Property("Alpha", 0.5, number()),
        Property("Buffer Length", 1, integer(1)),
    )
    length_label = "Buffer Length"

    def numbers(self, message: Any) -> float:
        """Return the opening angle [rad]. A range that is not finite is treated as out of range."""
        return float(message.field_of_view)

    def convert(self, message: Any, transform_frame_to_fixed: Matrix) -> Matrix:
        """Return the placement of the unit cone in the fixed frame, shape (4, 4).

        A measurement out of range has length 0. A sensor with a fixed distance (min_range equals
        max_range) reports -Inf for a nearer object.
        """
        length = 0.0  # [m]
        if message.min_range <= message.range <= message.max_range:
            length = float(message.range)
        elif message.min_range == message.max_range and isinf(message.range) and message.range < 0:
            length = float(message.min_range)
        width = 2 * length * tan(message.field_of_view / 2)
        center = (length / 2 - _RANGE_OFFSET * length, 0.0, 0.0)
        cone: Matrix = transform_frame_to_fixed @ placement(ALONG_MINUS_X, (width, width, length), center)
        return cone

    def drawables(self) -> Mapping[str, Drawable]:
        """Return all cones as one drawable."""
        return {"cones": Solids("cone", list(self.history), rgba_of(self))} if self.history else {}


# Lengths and diameters of shaft and head.
_UNIT_ARROW = (1.0, 0.1, 0.3, 0.2)
# Angles of the circle's points, with a gap for the tip.
_ARC = np.arange(4, 33) * 2 * np.pi / 32
# The rotation from x to y.
_ALONG_Y = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
_NAN_STATUS = "Message might contain floating point values (nans or infs)"


def _screw_properties(linear: str, angular: str) -> tuple[Property, ...]:
    return (
        Property(f"{linear} Color", (204, 51, 51), color),
        Property(f"{angular} Color", (204, 204, 51), color),
        Property("Alpha", 1.0, number()),
        Property(f"{linear} Arrow Scale", 2.0, number()),  # [m] per unit of the message
        Property(f"{angular} Arrow Scale", 2.0, number()),
        # Ten times the diameter of the shaft [m].
        Property("Arrow Width", 0.5, number()),
        Property("History Length", 1, integer(1, 100_000)),
    )


class ScrewDisplay(DrawnDisplay):
    """Base class for linear and angular vectors: an arrow, and an arrow with a circle around it."""

    # The message's field, and both vectors in it.
    path_to_vectors: ClassVar[tuple[str, str, str]]
    labels: ClassVar[tuple[str, str]] = ("Linear", "Angular")
    length_label = "History Length"
    properties = (
        *DrawnDisplay.properties,
        *_screw_properties(*labels),
        Property("Hide Small Values", True, flag),
    )

    def process(self, message: Any) -> None:
        """Keep the vectors, shape (2, 3), with the transform of their frame.

        A wrench may use NaN for 0.
        """
        field, *names = self.path_to_vectors
        pair = [getattr(getattr(message, field), name) for name in names]
        vectors = np.array([(v.x, v.y, v.z) for v in pair])
        if not np.isfinite(vectors).all():
            if not self._values.get("Accept NaN Values"):
                self.statuses.set("error", "Topic", INVALID)
                return
            self.statuses.set("ok", "Topic", _NAN_STATUS)
            vectors = np.nan_to_num(vectors, posinf=0.0, neginf=0.0)
        # RViz gives these displays no status of a known transform.
        stamp_ns = nanoseconds(message.header.stamp)
        transform = self.context.frames.transform(message.header.frame_id, stamp_ns)
        if transform is not None:
            self.keep((transform, vectors))

    def drawables(self) -> Mapping[str, Drawable]:
        """Return the arrows of all vectors, and the circles around the angular ones."""
        width = self["Arrow Width"]
        # WrenchDisplay does not have the property.
        hides = self._values.get("Hide Small Values", True)
        drawables: dict[str, Drawable] = {}
        for row, label in enumerate(self.labels):
            scale, rgba = self[f"{label} Arrow Scale"], rgba_of(self, f"{label} Color")
            visible_arrows = [
                (transform, vectors[row] / size, size * scale)
                for transform, vectors in self.history
                if (size := float(np.linalg.norm(vectors[row])))
                and (size * scale > self["Arrow Width"] or not hides)
            ]
            if not visible_arrows:
                continue
            poses = [
                transform @ placement(rotation_to(direction) @ ALONG_X.T, (length, width, width), np.zeros(3))
                for transform, direction, length in visible_arrows
            ]
            arrows = draw_arrows(poses, *_UNIT_ARROW, rgba=rgba)
            drawables |= {f"{label} {name}": drawable for name, drawable in arrows.items()}
            if label == self.labels[1]:
                tips, circles = zip(*(_circle_around(*arrow, width) for arrow in visible_arrows), strict=True)
                drawables["tips"] = Solids("cone", tips, rgba)
                line_width = abs(width) * 0.05
                drawables |= {f"circle {i}": Lines(c, rgba, line_width) for i, c in enumerate(circles)}
        return drawables


class WrenchDisplay(ScrewDisplay):
    """Forces and torques."""

    class_name = "rviz_default_plugins/Wrench"
    type_name = "geometry_msgs/msg/WrenchStamped"
    path_to_vectors = ("wrench", "force", "torque")
    labels = ("Force", "Torque")
    properties = (
        *DrawnDisplay.properties,
        Property("Accept NaN Values", False, flag),
        *_screw_properties(*labels),
    )


class TwistStampedDisplay(ScrewDisplay):
    """Velocities."""

    class_name = "rviz_default_plugins/TwistStamped"
    type_name = "geometry_msgs/msg/TwistStamped"
    path_to_vectors = ("twist", "linear", "angular")


class AccelStampedDisplay(ScrewDisplay):
    """Accelerations."""

    class_name = "rviz_default_plugins/AccelStamped"
    type_name = "geometry_msgs/msg/AccelStamped"
    path_to_vectors = ("accel", "linear", "angular")


def _circle_around(
    transform: Matrix, direction: Matrix, length: float, width: float
) -> tuple[Matrix, Matrix]:
    """Return a circle in the fixed frame: its tip's placement, and points, shape (N, 3), [m]."""
    # The shortest rotation from z to the direction; for -z Ogre rotates about y.
    rotation: Matrix = np.diag([-1.0, 1.0, -1.0])
    if direction[2] >= -1 + 1e-9:
        x, y, _ = direction
        cross = np.array([[0, 0, x], [0, 0, y], [-x, -y, 0]])
        rotation = np.eye(3) + cross + cross @ cross / (1 + direction[2])
    arrow_pose = transform @ placement(rotation, 1.0, (0.0, 0.0, 0.0))
    radius, height = length / 4, length / 2
    circle = np.column_stack([radius * np.cos(_ARC), radius * np.sin(_ARC), np.full(len(_ARC), height)])
    cone = placement(ALONG_X, (0.2 * width, 0.2 * width, 0.1 * width), (0.05 * width, 0.0, 0.0))
    tip = arrow_pose @ placement(_ALONG_Y, 1.0, (radius, 0.0, height)) @ cone
    return tip, circle @ arrow_pose[:3, :3].T + arrow_pose[:3, 3]


# Minimum radius [m], and minimum fraction of the limit.
_MIN_EFFORT = 0.05
# Angles of the circle's points; the tip fills the gap.
_EFFORT_ARC = np.arange(30) * 2 * np.pi / 32
_NO_LIMIT = (
    "Joint '{}' has no <limit> tag in URDF. Effort plugin needs to know the effort limit to "
    "determine the size of the corresponding visual marker. Effort display for this joint will "
    "be inhibited."
)
_SIZES_DIFFER = "Received a joint state msg with different joint names and efforts size!"


@dataclass(frozen=True, eq=False)
class JointEffort:
    """An effort about the z axis of a frame."""

    effort: float  # [N m]
    limit: float  # [N m]
    transform_to_fixed: Matrix  # shape (4, 4)

    @property
    def fraction(self) -> float:
        """The effort as a fraction of its limit (the effort itself without one), plus a minimum."""
        fraction = min(abs(self.effort) / self.limit, 1.0) if self.limit else abs(self.effort)
        return fraction + _MIN_EFFORT

    def draw(self, scale: float, width: float) -> tuple[Floats, Matrix]:
        """Return the circle's points in the fixed frame, shape (30, 3), and its tip's placement."""
        radius, sign = _MIN_EFFORT + self.fraction * scale / 2, -1 if self.effort < 0 else 1
        arc = np.column_stack([sign * np.sin(_EFFORT_ARC), np.cos(_EFFORT_ARC), 0 * _EFFORT_ARC]) * radius
        circle = arc @ self.transform_to_fixed[:3, :3].T + self.transform_to_fixed[:3, 3]
        along, side = (ALONG_MINUS_X, -1) if self.effort > 0 else (ALONG_X, 1)
        tip = placement(along, (4 * width, 4 * width, 2 * width), (side * width, radius, 0.0))
        return circle, self.transform_to_fixed @ tip


class EffortDisplay(DrawnDisplay):
    """Efforts of revolute joints: circular arrows about the axes, larger and redder near the limit."""

    class_name = "rviz_default_plugins/Effort"
    type_name = "sensor_msgs/msg/JointState"
    length_label = "History Length"
    properties = (
        *DrawnDisplay.properties,
        Property("Alpha", 1.0, number()),
        Property("Width", 0.02, number()),  # [m]
        # Diameter at the limit [m].
        Property("Scale", 1.0, number()),
        Property("History Length", 1, integer(1, 100_000)),
        Property("Robot Description", "/robot_description", text),
        Property("TF Prefix", "", text),
    )

    def __init__(self, *args: Any) -> None:
        super().__init__(*args)
        # Revolute and continuous joints with a limit, by name.
        self._joints: dict[str, Joint] | None = None

    def on_property_change(self, label: str) -> None:
        """Subscribe to another robot description, or redraw."""
        super().on_property_change(label)
        if label == "Robot Description" and self.is_started:
            self.start()

    def make_subscriptions(self) -> tuple[Subscription, ...]:
        """Subscribe to the joint states and to the robot description."""
        latched, topic = Qos(depth=1, durability="transient_local"), self["Robot Description"]
        description = self.subscription(topic, "std_msgs/msg/String", self._on_description, latched)
        return *super().make_subscriptions(), description

    def start(self) -> None:
        """Discard the robot, and subscribe."""
        self._joints = None
        self.remove_properties("Joints")
        super().start()

    def process(self, message: Any) -> None:
        """Show the efforts in a joint state.

        Joints without an effort in it keep their previous one.
        """
        if self._joints is None:
            self.statuses.set("error", "Process message", "Robot model might not be loaded yet")
            return
        self.statuses.delete("Process message")
        oldest = self.history.popleft() if len(self.history) == self.history.maxlen else {}
        if len(message.name) != len(message.effort):
            self.statuses.set("error", "Topic", _SIZES_DIFFER)
            self.draw()
            return
        stamp_ns = nanoseconds(message.header.stamp)
        values = dict(zip(message.name, map(float, message.effort), strict=True))
        efforts = {name: self._joint_effort(name, value, stamp_ns) for name, value in values.items()}
        self.keep({**oldest, **{name: effort for name, effort in efforts.items() if effort}})

    def drawables(self) -> Mapping[str, Drawable]:
        """Return circles and tips for the enabled joints."""
        width, scale = self["Width"], self["Scale"]
        drawables: dict[str, Drawable] = {}
        for index, efforts in enumerate(self.history):
            for name in (name for name in efforts if self[f"Joints/{name}"]):
                rgba = (*rainbow([efforts[name].fraction])[0], 1.0)
                circle, tip = efforts[name].draw(scale, width)
                node = f"{index} {node_name(name)}"
                drawables[f"{node} circle"] = Lines(circle, rgba, width)
                drawables[f"{node} tip"] = Solids("cone", [tip], rgba)
        return drawables

    def _on_description(self, message: Any) -> None:
        try:
            robot = parse_urdf(message.data)
        except CourseError as error:
            self.statuses.set("error", "URDF", "Unable to parse robot model description!")
            self.statuses.hint("URDF", str(error))
            return
        self.statuses.set("ok", "URDF", "Robot model parsed Ok")
        turning = {n: joint for n, joint in robot.joints.items() if joint.kind in ("revolute", "continuous")}
        lacking = [_NO_LIMIT.format(name) for name, joint in turning.items() if joint.effort is None]
        self.statuses.hint("URDF", *(f"RViz's log: {text}" for text in lacking))
        self._joints = {name: turning[name] for name in sorted(turning) if turning[name].effort is not None}
        for name, joint in self._joints.items():
            row, names = f"Joints/{name}", ("Joints", name)
            self.add_properties(
                Property(row, True, flag, names),
                Property(f"{row}/Effort", 0.0, read_only, (*names, "Effort")),
                Property(f"{row}/Max Effort", joint.effort, read_only, (*names, "Max Effort")),
            )

    def _joint_effort(self, name: str, effort: float, stamp_ns: int) -> JointEffort | None:
        """Return a joint's effort in the fixed frame, or None if RViz does not draw it."""
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
        # RViz rotates the joint's axis to z instead of z to the axis. So an axis that is not along
        # x, y or z is drawn in a wrong direction, and this code reproduces it.
        turn, normal = np.eye(4), np.cross(joint.axis, (0.0, 0.0, 1.0))
        if normal.any():
            turn[:3, :3] = axangle2mat(normal, np.arccos(joint.axis[2] / np.linalg.norm(joint.axis)))
        return JointEffort(effort, joint.effort, transform @ turn)


class GridCellsDisplay(DrawnDisplay):
    """The cells of the last message, as tiles in the xy plane of its frame."""

    class_name = "rviz_default_plugins/GridCells"
    type_name = "nav_msgs/msg/GridCells"
    is_in_message_frame = True
    properties = (
        *DrawnDisplay.properties,
        Property("Color", (25, 255, 0), color),
        Property("Alpha", 1.0, number(0.0, 1.0)),
    )

    def numbers(self, message: Any) -> Matrix:
        """Return the coordinates of all cells and their size in one row, [m]."""
        coordinates = [number for cell in message.cells for number in (cell.x, cell.y, cell.z)]
        return np.array([*coordinates, message.cell_width, message.cell_height])

    def process(self, message: Any) -> None:
        """Draw the cells. A message that RViz rejects clears the drawing."""
        self.history.clear()
        if message.cell_width == 0 or message.cell_height == 0:
            text = "One of the Cell's dimension is zero, cells will be invisible."
            self.statuses.set("error", "Topic", text)
        elif not message.cells:
            self.statuses.set("warn", "Topic", "Message is empty: there are no cells to be shown.")
        else:
            super().process(message)
        if not self.history:
            self.draw()

    def convert(self, message: Any, transform_frame_to_fixed: Matrix) -> Any:
        """Return the message unchanged."""
        return message

    def drawables(self) -> Mapping[str, Drawable]:
        """Return the tiles of the last message."""
        if not self.history:
            return {}
        message = self.history[0]
        centers = [(cell.x, cell.y, cell.z) for cell in message.cells]
        *rgb, alpha = rgba_of(self)
        drawn_alpha = alpha if alpha == 1 else float(alpha_drawn_twice(np.array(alpha)))
        size = (message.cell_width, message.cell_height)
        return {"cells": Points(centers, (*rgb, drawn_alpha), size, spot="tile")}
