"""ROS's robot_state_publisher: transforms from joint states."""

from typing import Any, Unpack

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
from course_lib.robots.urdf import MOVING, parse_urdf

_LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class RobotStatePublisher(Node):
    """Publishes /tf from /joint_states, /tf_static and /robot_description, by the rules of the ROS node.

    As there, a message about joints published less than a period ago, by its stamp, is ignored, also one
    whose stamp is 0; joints that the robot has not are ignored without a word.

    Args:
        robot_description: The text of a URDF, `load_robot("ur10").urdf`.
        publish_frequency: How often /tf is published at most, [Hz]; 0 for no limit.
        frame_prefix: Put before the names of all frames.
        ignore_timestamp: Whether every message is used, whatever its stamp.
        options: What any node takes.

    Raises:
        CourseError: If the description is empty or not valid, or the frequency not in 0..1000.
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
        super().__init__("robot_state_publisher", **options)
        self.declare_parameter("robot_description", robot_description)
        self.declare_parameter("publish_frequency", float(publish_frequency))
        self.declare_parameter("frame_prefix", frame_prefix)
        self.declare_parameter("ignore_timestamp", ignore_timestamp)
        self._published_ns: dict[str, int] = {}  # stamp of what was published last, by joint
        self._heard_ns = 0
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
        self.create_subscription(JointState, "joint_states", self._on_state, qos_profile_sensor_data)

    def set_description(self, text: str) -> None:
        """Replace the robot; raises a CourseError if the text is not a URDF."""
        if not text:
            raise CourseError("robot_description parameter must not be empty")
        self._tree = parse_urdf(text)
        named = sorted(self._tree.joints.items())
        self._mimics = [(name, joint.mimic) for name, joint in named if joint.mimic]
        self._description.publish(String(data=text))
        self.get_logger().info("Robot initialized")
        # KDL knows no planar and no floating joints: the ones count as fixed, the others are left out.
        fixed = [joint.name for joint in self._tree.joints.values() if joint.kind in ("fixed", "planar")]
        self._tf_static.publish(self._transforms(dict.fromkeys(fixed, 0.0), self.get_clock().now().to_msg()))

    def _on_parameters(self, parameters: list[Parameter]) -> SetParametersResult:
        """Apply changed parameters, as in ROS; a wrong one is refused."""
        for parameter in parameters:
            try:
                if parameter.name == "robot_description":
                    self.set_description(parameter.value)
                elif parameter.name == "publish_frequency":
                    _check_frequency(parameter.value)
            except CourseError as error:
                return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _value(self, parameter: str) -> Any:
        return self.get_parameter(parameter).value

    def _on_state(self, state: JointState) -> None:
        if len(state.name) != len(state.position):
            self._refuse(state)
        elif self._is_due(state):
            # Of a joint that is named twice the first position counts.
            positions = dict(zip(reversed(state.name), reversed(state.position), strict=True))
            for name, mimic in self._mimics:
                if mimic.joint in positions:
                    positions.setdefault(name, positions[mimic.joint] * mimic.factor + mimic.offset)
            joints = self._tree.joints
            moving = {n: p for n, p in positions.items() if n in joints and joints[n].kind in MOVING}
            self._tf.publish(self._transforms(moving, state.header.stamp))
            self._published_ns |= dict.fromkeys(state.name, Time.from_msg(state.header.stamp).nanoseconds)

    def _refuse(self, state: JointState) -> None:
        if len(state.position) > 0:
            self.get_logger().error("Robot state publisher ignored an invalid JointState message")
            return
        self.get_logger().warning(
            "Robot state publisher ignored a JointState message about joint(s) "
            f'"{state.name[0]}"(,...) whose position member was empty.'
        )

    def _is_due(self, state: JointState) -> bool:
        now_ns = self.get_clock().now().nanoseconds
        if now_ns < self._heard_ns:
            self.get_logger().warning("Moved backwards in time, re-publishing joint transforms!")
            self._published_ns.clear()
        self._heard_ns = now_ns
        last_ns = min([now_ns, *(self._published_ns.get(name, 0) for name in state.name)])
        frequency = self._value("publish_frequency")
        period_ns = int(1000.0 / frequency) * 10**6 if frequency else 0  # in whole milliseconds, as in ROS
        late_enough = Time.from_msg(state.header.stamp).nanoseconds >= last_ns + period_ns
        return late_enough or bool(self._value("ignore_timestamp"))

    def _transforms(self, positions: dict[str, float], stamp: TimeMsg) -> TFMessage:
        prefix, message = self._value("frame_prefix"), TFMessage()
        for name, pose in sorted(joint_poses(self._tree, positions).items()):
            joint, moved = self._tree.joints[name], TransformStamped()
            moved.header.stamp = stamp
            moved.header.frame_id, moved.child_frame_id = prefix + joint.parent, prefix + joint.child
            place, turn = moved.transform.translation, moved.transform.rotation
            place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w = pose.tolist()
            message.transforms.append(moved)
        return message


def _check_frequency(frequency: float) -> None:
    if not 0.0 <= frequency <= 1000.0:
        raise CourseError("publish_frequency must be between 0 and 1000")
