"""ROS's robot_state_publisher, and joint_state_publisher with sliders for its joints."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import pi
from typing import TYPE_CHECKING, Any, Unpack

from builtin_interfaces.msg import Time as TimeMsg
from geometry_msgs.msg import TransformStamped
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node, NodeOptions
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rclpy.time import Time
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from course_lib.errors import CourseError
from course_lib.robots.kinematics import joint_poses
from course_lib.robots.trajectory import period_of
from course_lib.robots.urdf import MANY_RADIANS, MOVING, Joint, Mimic, parse_urdf
from course_lib.ros.near_names import nearest
from course_lib.ros.notices import print_notice
from course_lib.ros.time import pace

if TYPE_CHECKING:
    from ipywidgets import HBox, VBox

_KINDS = ("position", "velocity", "effort")
# Maximum length of a slider's name, in characters. Longer names are truncated.
LONGEST_NAME = 26
# The number of hints that a node prints about joint states.
_MOST_HINTS = 5
_DEPENDENT = ("parent", "factor", "offset")
_DEFAULTS: dict[str, Any] = {
    "publish_default_efforts": False,
    "publish_default_positions": True,
    "publish_default_velocities": False,
    "source_list": list[str](),
    "use_mimic_tags": True,
    "use_smallest_joint_limits": True,
    "delta": 0.0,
}


@dataclass
class FreeJoint:
    """A joint that can be set: limits, initial and current state, in its unit.

    None is not published.
    """

    unit: str
    lower: float
    upper: float
    zero: float
    position: float | None
    velocity: float | None = None
    effort: float | None = None
    is_continuous: bool = False
    # Whether the parameter `delta` currently increases the position.
    is_moving_up: bool = True
    # The newest slider, which follows the position.
    slider: Any = field(default=None, repr=False, compare=False)

    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, value)
        slider = self.slider if name == "position" and isinstance(value, (int, float)) else None
        # Outside of its limits, a slider would replace the joint's position by the limit.
        if slider is not None and slider.min <= value <= slider.max:
            slider.value = value


class JointStatePublisher(Node):
    """Publishes /joint_states for a robot, with the rules and parameters of the ROS node.

    Joints start at 0, or in the middle of limits that exclude 0. They keep the value set by
    `joints[name].position` or by a topic of the parameter `source_list`; mimic joints follow. The
    robot is the given one, until a message on /robot_description replaces it. As in ROS 2,
    `dependent_joints` is checked, and a description replaces it.

    Args:
        robot_description: The text of a URDF; if empty, the node waits for /robot_description.
        rate: Publishing rate, [Hz].
        zeros: Initial positions by joint name, [rad] or [m].
        options: Options of any node.

    Raises:
        CourseError: The description is invalid, a joint has no limits, or the rate is not positive.
    """

    def __init__(
        self,
        robot_description: str = "",
        *,
        rate: int = 10,
        zeros: Mapping[str, float] | None = None,
        **options: Unpack[NodeOptions],
    ) -> None:
        options.setdefault("automatically_declare_parameters_from_overrides", True)
        super().__init__("joint_state_publisher", **options)
        for name, value in {"rate": rate, **_DEFAULTS}.items():
            if not self.has_parameter(name):
                self.declare_parameter(name, value)
        # As in ROS, all parameters are read once: later changes have no effect.
        self._settings = {name: self.get_parameter(name).value for name in ("rate", *_DEFAULTS)}
        zeros_from_parameters = {
            name: parameter.value for name, parameter in self.get_parameters_by_prefix("zeros").items()
        }
        self.joints: dict[str, FreeJoint] = {}
        # Called after the robot has changed.
        self.on_robot: list[Callable[[], None]] = []
        self._zeros = {**(zeros or {}), **zeros_from_parameters}
        # The joint that each joint follows, in the order of the file.
        self._mimics: dict[str, Mimic] = {}
        try:
            period = period_of(self._settings["rate"])
            self._check_dependent_joints()
            if robot_description:
                self.set_description(robot_description)
        except CourseError:
            self.destroy_node()
            raise
        if not robot_description:
            self.get_logger().info(
                "Waiting for robot_description to be published on the robot_description topic..."
            )
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_subscription(String, "robot_description", self._on_description, latched)
        for topic in self._settings["source_list"]:
            self.create_subscription(JointState, topic, self._on_source, 10)
        self._publisher = self.create_publisher(JointState, "joint_states", 10)
        self.create_timer(period, self._publish)

    def _check_dependent_joints(self) -> None:
        names = self.get_parameters_by_prefix("dependent_joints")
        for name in names:
            joint, dot, part = name.rpartition(".")
            if not dot or "." in joint:
                raise CourseError(f"Invalid dependent_joint name '{name}'")
            if part not in _DEPENDENT:
                allowed_keys = ", ".join(f"'{word}'" for word in _DEPENDENT)
                raise CourseError(
                    f"Invalid dependent_joint name '{part}' (allowed values are {allowed_keys})"
                )
            if f"{joint}.parent" not in names:
                raise CourseError("All dependent_joints must at least have a parent")

    def set_description(self, text: str) -> None:
        """Replace the robot. Its joints start at their zeros.

        Raises a CourseError if a joint has no limits.
        """
        tree = parse_urdf(text)
        moving = [joint for joint in tree.joints.values() if joint.kind in MOVING]
        uses_mimic = self._settings["use_mimic_tags"]
        follows = {
            joint.name: tree.resolve_mimic(joint) if uses_mimic else Mimic(joint.name, 1.0, 0.0)
            for joint in moving
        }
        joints = {
            joint.name: self._free_joint(joint) for joint in moving if follows[joint.name].joint == joint.name
        }
        self.joints, self._mimics = joints, follows
        for tell in self.on_robot:
            tell()

    def _free_joint(self, joint: Joint) -> FreeJoint:
        limits = dict(joint.limits)
        if joint.kind == "continuous":
            limits |= {"lower": -pi, "upper": pi}
        for side in ("lower", "upper"):
            if side not in limits:
                raise CourseError(
                    f'"{side}" limit must be specified for joint "{joint.name}" of type "{joint.kind}"'
                )
        lower, upper = limits["lower"], limits["upper"]
        if self._settings["use_smallest_joint_limits"]:
            lower = max(lower, limits.get("soft_lower_limit", lower))
            upper = min(upper, limits.get("soft_upper_limit", upper))
        zero = float(self._zeros.get(joint.name, (lower + upper) / 2 if lower > 0 or upper < 0 else 0.0))
        return FreeJoint(
            joint.unit,
            lower,
            upper,
            zero,
            position=zero if self._settings["publish_default_positions"] else None,
            velocity=0.0 if self._settings["publish_default_velocities"] else None,
            effort=0.0 if self._settings["publish_default_efforts"] else None,
            is_continuous=joint.kind == "continuous",
        )

    def _on_description(self, message: String) -> None:
        try:
            self.set_description(message.data)
        except CourseError as error:
            self.get_logger().warning(str(error))

    def _on_source(self, message: JointState) -> None:
        for index, name in enumerate(message.name):
            for kind in _KINDS:
                values = getattr(message, kind)
                if name in self.joints and index < len(values):
                    setattr(self.joints[name], kind, values[index])

    def _publish(self) -> None:
        state = JointState(name=list(self._mimics))
        state.header.stamp = self.get_clock().now().to_msg()
        delta = self._settings["delta"]
        for joint in self.joints.values() if delta > 0 else ():
            if joint.position is None:
                continue
            # A step, which reverses its direction at a limit.
            joint.position += delta if joint.is_moving_up else -delta
            if joint.position > joint.upper and joint.is_moving_up:
                joint.position = joint.lower if joint.is_continuous else joint.upper
                joint.is_moving_up = joint.is_continuous
            elif joint.position < joint.lower and not joint.is_moving_up:
                joint.position, joint.is_moving_up = joint.lower, True
        for kind in _KINDS:
            known_values = {
                name: value for name, j in self.joints.items() if (value := getattr(j, kind)) is not None
            }
            # Dependent joints have positions even if the position of no other joint is known.
            if known_values or (kind == "position" and len(self.joints) < len(self._mimics)):
                values = []
                # A joint follows another one or itself.
                for follow in self._mimics.values():
                    value = 0.0
                    if follow.joint in known_values:
                        value = float(known_values[follow.joint])
                        value *= 1.0 if kind == "effort" else follow.factor
                        value += follow.offset if kind == "position" else 0.0
                    values.append(value)
                setattr(state, kind, values)
        if state.name:
            self._publisher.publish(state)


def joint_sliders(publisher: JointStatePublisher) -> "VBox | None":
    """Return a slider for each joint of a joint state publisher, or None without a page.

    Their values are published while the node runs: `run_live(publisher)`. Tab moves to the next
    slider, arrow keys change the value by a thousandth of its range, and the number can be edited.
    """
    if pace.mode() == "fast":
        return None
    import ipywidgets

    # Imported here because anywidget is slow to import.
    from course_lib.controls import ControlBox

    center = ipywidgets.Button(description="Center", tooltip="All joints to where they began")
    box = ControlBox([center], lambda: _describe(publisher.joints))

    def build() -> None:
        width = f"{min(max(map(len, publisher.joints), default=0), LONGEST_NAME)}ch"
        box.children = [center, *(_row(name, joint, width) for name, joint in publisher.joints.items())]

    def reset_joints(_: Any) -> None:
        for row, joint in zip(box.children[1:], publisher.joints.values(), strict=True):
            row.children[0].value = joint.zero

    center.on_click(reset_joints)
    publisher.on_robot.append(build)
    build()
    return box


def _describe(joints: Mapping[str, FreeJoint]) -> str:
    """Return the values of the sliders as text, for pages without widgets."""
    lines = ["Sliders of joints were here. Run this cell to use them."]
    for name, joint in joints.items():
        position = joint.zero if joint.position is None else joint.position
        lower, upper = sorted((joint.lower, joint.upper))
        lines.append(f"{name}: {position:.3f} ({lower:.3f} … {upper:.3f} {joint.unit})")
    return "\n".join(lines)


def _row(name: str, joint: FreeJoint, width: str) -> "HBox":
    """Return a slider whose name is `width` wide, and its limits, which are never cut off."""
    import ipywidgets

    from course_lib.controls import Slider

    lower, upper = sorted((joint.lower, joint.upper))
    slider = Slider(
        value=joint.zero if joint.position is None else joint.position,
        min=lower,
        max=upper,
        step=(upper - lower) / 1000,
        description=name,
        description_width=width,
        layout={"width": "34em"},
    )
    slider.observe(lambda change: setattr(joint, "position", change["new"]), "value")
    joint.slider = slider
    limits = ipywidgets.Label(f"{lower:.3f} … {upper:.3f} {joint.unit}", layout={"flex": "none"})
    return ipywidgets.HBox([slider, limits])


_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class RobotStatePublisher(Node):
    """Publishes /tf from /joint_states, /tf_static and /robot_description, with the rules of the ROS node.

    As in ROS, a joint state is ignored if its stamp is 0 or less than a period after the last one,
    and unknown joints are ignored silently.

    Args:
        robot_description: The text of a URDF, like `load_robot("ur10").urdf`.
        publish_frequency: Maximum rate of /tf, [Hz]; 0 for no limit.
        frame_prefix: Prefix of all frame names.
        ignore_timestamp: Whether every message is used, whatever its stamp.
        options: Options of any node.

    Raises:
        CourseError: The description is empty or invalid, or the frequency is not in 0..1000.
    """

    def __init__(
        self,
        robot_description: str = "",
        *,
        publish_frequency: float = 20.0,
        frame_prefix: str = "",
        ignore_timestamp: bool = False,
        **options: Unpack[NodeOptions],
    ) -> None:
        if not isinstance(robot_description, str):
            kind = type(robot_description).__name__
            raise CourseError(
                f"robot_description is of type {kind}; expected the text of a URDF, like "
                'load_robot("ur10").urdf or open("arm.urdf").read().'
            )
        super().__init__("robot_state_publisher", **options)
        self.declare_parameter("robot_description", robot_description)
        self.declare_parameter("publish_frequency", float(publish_frequency))
        self.declare_parameter("frame_prefix", frame_prefix)
        self.declare_parameter("ignore_timestamp", ignore_timestamp)
        # Stamp of the last published transform by joint.
        self._published_ns: dict[str, int] = {}
        # Joints that got a hint, or need none.
        self._hinted = set[str]()
        self._hint_count = 0
        self._received_ns = 0
        self._tf = self.create_publisher(TFMessage, "/tf", 100)
        self._tf_static = self.create_publisher(TFMessage, "/tf_static", _LATCHED)
        self._description = self.create_publisher(String, "robot_description", _LATCHED)
        try:
            _check_frequency(self._value("publish_frequency"))
            self.set_description(self._value("robot_description"))
        except CourseError:
            self.destroy_node()
            raise
        self.add_on_set_parameters_callback(self._on_parameters)
        self.add_post_set_parameters_callback(self._on_set)
        self.create_subscription(JointState, "joint_states", self._on_state, qos_profile_sensor_data)

    def set_description(self, text: str) -> None:
        """Replace the robot, or raise a CourseError if the text is not a URDF."""
        if not text:
            raise CourseError("robot_description parameter must not be empty")
        self._tree = parse_urdf(text)
        named_joints = sorted(self._tree.joints.items())
        self._mimics = [(name, joint.mimic) for name, joint in named_joints if joint.mimic]
        self._description.publish(String(data=text))
        self.get_logger().info("Robot initialized")
        # KDL supports neither planar joints, which are treated as fixed, nor floating joints, which
        # are ignored.
        fixed = [joint.name for joint in self._tree.joints.values() if joint.kind in ("fixed", "planar")]
        self._tf_static.publish(self._transforms(dict.fromkeys(fixed, 0.0), self.get_clock().now().to_msg()))

    def _on_parameters(self, parameters: list[Parameter]) -> SetParametersResult:
        """Reject an invalid parameter with ROS's reason."""
        for parameter in parameters:
            try:
                if parameter.name == "robot_description":
                    if not parameter.value:
                        raise CourseError("Empty URDF is not allowed")
                    parse_urdf(parameter.value)
                elif parameter.name == "publish_frequency":
                    # ROS formats the limits differently than at startup.
                    _check_frequency(parameter.value, "0.0 and 1000.0")
            except CourseError as error:
                return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _on_set(self, parameters: list[Parameter]) -> None:
        """Replace the robot after all parameters of a request were accepted."""
        for parameter in parameters:
            if parameter.name == "robot_description":
                self.set_description(parameter.value)

    def _value(self, parameter: str) -> Any:
        return self.get_parameter(parameter).value

    def _on_state(self, state: JointState) -> None:
        if len(state.name) != len(state.position) and len(state.position) > 0:
            self.get_logger().error("Robot state publisher ignored an invalid JointState message")
        elif len(state.name) != len(state.position):
            self.get_logger().warning(
                "Robot state publisher ignored a JointState message about joint(s) "
                f'"{state.name[0]}"(,...) whose position member was empty.'
            )
        elif self._is_due(state):
            # If a joint is named twice, its first position is used.
            positions = dict(zip(reversed(state.name), reversed(state.position), strict=True))
            for name, mimic in self._mimics:
                if mimic.joint in positions:
                    positions.setdefault(name, positions[mimic.joint] * mimic.factor + mimic.offset)
            joints = self._tree.joints
            self._report_slips(state)
            moving = {n: p for n, p in positions.items() if n in joints and joints[n].kind in MOVING}
            self._tf.publish(self._transforms(moving, state.header.stamp))
            self._published_ns |= dict.fromkeys(state.name, Time.from_msg(state.header.stamp).nanoseconds)
        else:
            self._report_slips(state)

    def _report_slips(self, state: JointState) -> None:
        """Print hints about a joint state that ROS's node accepts without a message, each once."""
        joints = self._tree.joints
        if state.header.stamp.sec == state.header.stamp.nanosec == 0 and not self._value("ignore_timestamp"):
            self._hint(
                "", "has no stamp, and is ignored: set header.stamp to self.get_clock().now().to_msg()."
            )
        for name, position in zip(state.name, state.position, strict=True):
            if name in self._hinted:
                continue
            joint = joints.get(name)
            if joint is not None:
                if joint.kind == "revolute" and abs(position) > MANY_RADIANS:
                    text = f"moves {name} to {position:g}: positions are in radians, 90° is 1.5708."
                    self._hint(name, text)
                continue
            of_link = next((one.name for one in joints.values() if one.child == name), "")
            free_names = {one.name for one in joints.values() if one.kind in MOVING} - set(state.name)
            if of_link:
                self._hint(name, f"names {name}, which is a link: its joint is {of_link}.")
            elif near := nearest(name, free_names, 0.8):
                self._hint(name, f"names {name}, which the robot does not have: did you mean {near}?")
            else:
                # A robot's states may contain joints that its description lacks, such as a gripper
                # joint.
                self._hinted.add(name)

    def _hint(self, joint: str, text: str) -> None:
        """Print a hint about the joint states, one for each joint; "" stands for all joints."""
        if joint not in self._hinted and self._hint_count < _MOST_HINTS:
            print_notice(f"hint: a message on /joint_states {text}")
            self._hint_count += 1
        self._hinted.add(joint)

    def _is_due(self, state: JointState) -> bool:
        now_ns = self.get_clock().now().nanoseconds
        if now_ns < self._received_ns:
            self.get_logger().warning("Moved backwards in time, re-publishing joint transforms!")
            self._published_ns.clear()
        self._received_ns = now_ns
        last_ns = min([now_ns, *(self._published_ns.get(name, 0) for name in state.name)])
        frequency = self._value("publish_frequency")
        # As in ROS, the period is in whole milliseconds.
        period_ns = int(1000.0 / frequency) * 10**6 if frequency else 0
        late_enough = Time.from_msg(state.header.stamp).nanoseconds >= last_ns + period_ns
        return late_enough or bool(self._value("ignore_timestamp"))

    def _transforms(self, positions: dict[str, float], stamp: TimeMsg) -> TFMessage:
        prefix, message = self._value("frame_prefix"), TFMessage()
        for name, pose in sorted(joint_poses(self._tree, positions).items()):
            joint, transform = self._tree.joints[name], TransformStamped()
            transform.header.stamp = stamp
            transform.header.frame_id, transform.child_frame_id = prefix + joint.parent, prefix + joint.child
            place, turn = transform.transform.translation, transform.transform.rotation
            place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w = pose.tolist()
            message.transforms.append(transform)
        return message


def _check_frequency(frequency: float, limits: str = "0 and 1000") -> None:
    if not 0.0 <= frequency <= 1000.0:
        raise CourseError(f"publish_frequency must be between {limits}")
