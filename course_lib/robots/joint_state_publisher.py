"""ROS's joint_state_publisher, and sliders that move it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING, Any, Unpack

from rclpy.node import Node, NodeOptions
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.robots.period import period_of
from course_lib.robots.urdf import MOVING, Follow, Joint, parse_urdf
from course_lib.ros import pace

if TYPE_CHECKING:
    from ipywidgets import HBox, VBox


@dataclass
class FreeJoint:
    """A joint that can be set: limits, start and present position, all in its unit."""

    unit: str
    lower: float
    upper: float
    zero: float
    position: float


class JointStatePublisher(Node):
    """Publishes /joint_states for a robot, by the rules of the ROS node.

    Joints begin at 0, or in the middle of limits that exclude 0, and stay where `joints[name].position` puts
    them; mimic joints follow. The robot is the one given, then whatever /robot_description brings.

    Args:
        robot_description: The text of a URDF; if empty, the node waits for /robot_description.
        rate: How often it publishes, [Hz].
        zeros: Where joints begin instead, by name, [rad] or [m].
        options: What any node takes.

    Raises:
        CourseError: If the description is not valid or a joint has no limits, or the rate is not above 0.
    """

    def __init__(
        self,
        robot_description: str = "",
        *,
        rate: int = 10,
        zeros: Mapping[str, float] | None = None,
        **options: Unpack[NodeOptions],
    ) -> None:
        super().__init__("joint_state_publisher", **options)
        rate = self.declare_parameter("rate", rate).value
        self.joints: dict[str, FreeJoint] = {}
        self.on_robot: list[Callable[[], None]] = []  # called when the robot has changed
        self._zeros = dict(zeros or {})
        self._follows: dict[str, Follow] = {}  # what places each joint, in the order of the file
        try:
            period = period_of(rate)
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
        self._publisher = self.create_publisher(JointState, "joint_states", 10)
        self.create_timer(period, self._publish)

    def set_description(self, text: str) -> None:
        """Replace the robot; its joints start at their zeros. Raises a CourseError if one has no limits."""
        tree = parse_urdf(text)
        moving = [joint for joint in tree.joints.values() if joint.kind in MOVING]
        follows = {joint.name: tree.followed(joint) for joint in moving}
        joints = {
            joint.name: self._free(joint) for joint in moving if follows[joint.name].joint == joint.name
        }
        self.joints, self._follows = joints, follows
        for tell in self.on_robot:
            tell()

    def _free(self, joint: Joint) -> FreeJoint:
        limits = dict(joint.limits)
        if joint.kind == "continuous":
            limits |= {"lower": -pi, "upper": pi}
        for side in ("lower", "upper"):
            if side not in limits:
                raise CourseError(
                    f'"{side}" limit must be specified for joint "{joint.name}" of type "{joint.kind}"'
                )
        lower = max(limits["lower"], limits.get("soft_lower_limit", limits["lower"]))
        upper = min(limits["upper"], limits.get("soft_upper_limit", limits["upper"]))
        zero = self._zeros.get(joint.name, (lower + upper) / 2 if lower > 0 or upper < 0 else 0.0)
        return FreeJoint(joint.unit, lower, upper, zero, zero)

    def _on_description(self, message: String) -> None:
        try:
            self.set_description(message.data)
        except CourseError as error:
            self.get_logger().warning(str(error))

    def _publish(self) -> None:
        state = JointState(name=list(self._follows))
        state.header.stamp = self.get_clock().now().to_msg()
        for follow in self._follows.values():
            state.position.append(self.joints[follow.joint].position * follow.factor + follow.offset)
        if state.name:
            self._publisher.publish(state)


def joint_sliders(publisher: JointStatePublisher) -> "VBox | None":
    """Return a slider for each joint of a joint state publisher; None without a page.

    What they say is published while the node runs: `run_live(publisher)`. Tab goes from one to the next,
    arrow keys move it by a thousandth of its range, and its number may be typed.
    """
    if pace.wanted() == "fast":
        return None
    import ipywidgets

    center = ipywidgets.Button(description="Center", tooltip="All joints to where they began")
    box = ipywidgets.VBox()

    def build() -> None:
        box.children = [center, *(_row(name, joint) for name, joint in publisher.joints.items())]

    def to_zeros(_: Any) -> None:
        for row, joint in zip(box.children[1:], publisher.joints.values(), strict=True):
            row.children[0].value = joint.zero

    center.on_click(to_zeros)
    publisher.on_robot.append(build)
    build()
    return box


def _row(name: str, joint: FreeJoint) -> "HBox":
    import ipywidgets

    from course_lib.controls.slider import Slider  # here: anywidget is slow to load

    lower, upper = sorted((joint.lower, joint.upper))
    slider = Slider(
        value=joint.position,
        min=lower,
        max=upper,
        step=(upper - lower) / 1000,
        description=name,
        description_width="14em",
        layout={"width": "34em"},
    )
    slider.observe(lambda change: setattr(joint, "position", change["new"]), "value")
    return ipywidgets.HBox([slider, ipywidgets.Label(f"{lower:.3f} … {upper:.3f} {joint.unit}")])
