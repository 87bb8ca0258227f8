"""A robot to be explored: `ros2 run unknown_robot robot`, `course robot unknown`, or its nodes.

Students of week 6 find out its properties with the tools of ROS. The properties therefore depend on
the robot's serial number, and they are set only while the robot runs, so that reading the source or
the parameters of a node that does not run does not reveal them.
"""

import hashlib
import math
import time
from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from typing import Any, TypeVar

import numpy as np
from control_msgs.action import GripperCommand
from geometry_msgs.msg import PoseStamped, TransformStamped
from nav_msgs.msg import Odometry, Path
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.action import ActionServer
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import BatteryState, Image, Imu, JointState, LaserScan, Temperature
from std_msgs.msg import Bool, Float64
from std_srvs.srv import Trigger
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster
from vision_msgs.msg import Detection3D, Detection3DArray
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.errors import CourseError

# Radius [m] and angular speed [rad/s] of its circle.
RADIUS, TURN = 2.0, 0.3
# Distance from the center of the room to its walls [m].
ROOM = 5.0
# Processing time of the detector per image [s].
MODELS = {"large": 0.15, "small": 0.005}
# Drift of the gyroscope [rad/s].
DRIFT = 0.02
# Delay until a node sets its properties [s].
BOOT = 0.001
# In hertz.
RATES = (11.0, 13.0, 14.0, 16.0, 17.0, 19.0, 21.0, 22.0, 24.0, 26.0, 27.0, 29.0)
# In pixels.
WIDTHS = (32, 40, 48, 56, 72, 80, 88, 96)
THRESHOLDS = (0.35, 0.4, 0.45, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9)
TRIGGERS = ("zero_imu", "release_brakes", "home_gripper", "clear_map", "reset_encoders", "test_lights")
Option = TypeVar("Option")


class RobotPart(Node):
    """A node in the namespace `robot` that sets its properties after it has started to run.

    Robot number 0 has fixed properties, and three faults.
    """

    def __init__(self, name: str, serial: int) -> None:
        super().__init__(name, namespace="robot")
        self._serial = serial
        if serial:
            self._boot_timer = self.create_timer(BOOT, self._boot)

    def _boot(self) -> None:
        self._boot_timer.cancel()
        self.begin()

    def begin(self) -> None:
        """Set the properties."""

    def _select(self, options: Sequence[Option]) -> Option:
        """Return one of several options, selected by the robot's number and the node's name.

        Raises:
            CourseError: The robot does not run.
        """
        if self.executor is None:
            raise CourseError("This robot is not running. Start it with run_live(...), then use %ros2.")
        key = f"{self._serial} {self.get_fully_qualified_name()} {len(options)}"
        digest = hashlib.blake2b(key.encode(), digest_size=8).digest()
        return options[int.from_bytes(digest, "big") % len(options)]


class CameraDriver(RobotPart):
    """Publishes images at the rate given by its parameter."""

    def __init__(self, serial: int) -> None:
        super().__init__("camera_driver", serial)
        span = ParameterDescriptor(
            description="images per second [Hz]",
            floating_point_range=[FloatingPointRange(from_value=1.0, to_value=60.0)],
        )
        self.declare_parameter("frame_rate", 30.0, span)
        self.declare_parameter("frame_id", "camera_link")
        # In pixels, and the number of images.
        self._width, self._count = 64, 0
        self._images = self.create_publisher(Image, "front_cam/image_raw", qos_profile_sensor_data)
        self.add_post_set_parameters_callback(self._start)
        self._timer: Any = None
        if not serial:
            self._start([self.get_parameter("frame_rate")])

    def begin(self) -> None:
        """Set the size and the rate of the images."""
        self._width = self._select(WIDTHS)
        self.set_parameters([Parameter("frame_rate", value=self._select(RATES))])

    def _start(self, changed: Sequence[Parameter]) -> None:
        if not any(parameter.name == "frame_rate" for parameter in changed):
            return
        if self._timer is not None:
            self.destroy_timer(self._timer)
        rate = self.get_parameter("frame_rate").value
        self._timer = self.create_timer(1 / rate, self._take)
        self.get_logger().info(f"{rate:g} images per second")

    def _take(self) -> None:
        wide, high = self._width, self._width * 3 // 4
        pixels = np.full((high, wide, 3), (40, 60, 90), np.uint8)
        pixels[:, self._count % wide :][:, :6] = (240, 160, 40)
        self._count += 1
        image = Image(height=high, width=wide, encoding="rgb8", step=3 * wide, data=pixels.tobytes())
        image.header.frame_id = self.get_parameter("frame_id").value
        image.header.stamp = self.get_clock().now().to_msg()
        self._images.publish(image)


class BoxDetector(RobotPart):
    """Publishes a detected box some time after each image."""

    def __init__(self, serial: int) -> None:
        super().__init__("detector", serial)
        self.declare_parameter("model", "small" if serial else "large")
        self.declare_parameter("threshold", 0.5)
        newest = QoSProfile(depth=1, reliability=qos_profile_sensor_data.reliability)
        self.create_subscription(Image, "front_cam/image_raw", self._detect, newest)
        self._detections = self.create_publisher(Detection3DArray, "detections", 10)
        self._markers = self.create_publisher(MarkerArray, "annotations", 10)

    def begin(self) -> None:
        """Set the threshold."""
        self.set_parameters([Parameter("threshold", value=self._select(THRESHOLDS))])

    def _detect(self, image: Image) -> None:
        time.sleep(MODELS.get(self.get_parameter("model").value, 0.0))
        found = Detection3D(header=image.header, id="1")
        # 2 m ahead.
        found.bbox.center.position.x = 2.0
        self._detections.publish(Detection3DArray(header=image.header, detections=[found]))
        marker = Marker(ns="boxes", type=Marker.CUBE, pose=found.bbox.center)
        # Without a stamp, the marker is drawn with the latest transforms.
        marker.header.frame_id = found.header.frame_id
        marker.scale.x = marker.scale.y = marker.scale.z = 0.6
        marker.color.g, marker.color.a = 0.8, 0.8
        self._markers.publish(MarkerArray(markers=[marker]))


class LidarDriver(RobotPart):
    """Publishes scans of a square room."""

    def __init__(self, serial: int) -> None:
        super().__init__("lidar_driver", serial)
        self.declare_parameter("frame_id", "laser_link" if serial else "lasr_link")
        if not serial:
            self._publish(qos_profile_sensor_data)

    def begin(self) -> None:
        """Set the reliability of the scans."""
        self._publish(self._select((QoSProfile(depth=10), qos_profile_sensor_data)))

    def _publish(self, qos: QoSProfile) -> None:
        self._scans = self.create_publisher(LaserScan, "scan", qos)
        self.create_timer(0.1, self._scan)

    def _scan(self) -> None:
        x, y, yaw = robot_pose(self)
        angles = np.linspace(-math.pi / 2, math.pi / 2, 91)
        ahead = np.array([np.cos(angles + yaw), np.sin(angles + yaw)])  # shape (2, 91)
        walls = (np.sign(ahead) * ROOM - np.array([[x], [y]])) / np.where(ahead == 0, 1e-9, ahead)
        scan = LaserScan(angle_min=-math.pi / 2, angle_max=math.pi / 2, range_min=0.1, range_max=20.0)
        scan.angle_increment, scan.ranges = math.pi / 90, walls.min(axis=0).tolist()
        scan.header.frame_id = self.get_parameter("frame_id").value
        scan.header.stamp = self.get_clock().now().to_msg()
        self._scans.publish(scan)


class BaseDriver(RobotPart):
    """Simulates a base that drives in a circle, with its odometry, gyroscope, frames, plan and a service."""

    def __init__(self, serial: int) -> None:
        super().__init__("base_driver", serial)
        self._odometry = self.create_publisher(Odometry, "odom", 10)
        self._imu = self.create_publisher(Imu, "imu/data", qos_profile_sensor_data)
        self._tf, self._fixed = TransformBroadcaster(self), StaticTransformBroadcaster(self)
        self._fixed.sendTransform(
            [stamped_transform(self, "base_link", name, 0.2) for name in ("laser_link", "camera_link")]
        )
        self._plans = self.create_publisher(Path, "plan", 10)
        self.create_timer(1.0, self._plan)
        if not serial:
            self.create_service(Trigger, "reset_odometry", partial(self._trigger, "odometry is 0 now"))
        self.create_timer(0.05, self._drive)

    def begin(self) -> None:
        """Create the service."""
        self.create_service(Trigger, self._select(TRIGGERS), partial(self._trigger, "done"))

    def _drive(self) -> None:
        x, y, yaw = robot_pose(self)
        frame = stamped_transform(self, "odom", "base_link", x, y, yaw)
        self._tf.sendTransform(frame)
        odometry = Odometry(header=frame.header, child_frame_id="base_link")
        odometry.pose.pose.position.x, odometry.pose.pose.position.y = x, y
        odometry.pose.pose.orientation = frame.transform.rotation
        odometry.twist.twist.linear.x, odometry.twist.twist.angular.z = RADIUS * TURN, TURN
        self._odometry.publish(odometry)
        imu = Imu(header=frame.header)
        imu.header.frame_id, imu.angular_velocity.z = "base_link", TURN + DRIFT
        self._imu.publish(imu)

    def _plan(self) -> None:
        plan = Path(header=stamped_transform(self, "odom", "", 0.0).header)
        for angle in np.linspace(0.0, math.tau, 41):
            pose = PoseStamped(header=plan.header)
            pose.pose.position.x = RADIUS * math.cos(angle)
            pose.pose.position.y = RADIUS * math.sin(angle)
            plan.poses.append(pose)
        self._plans.publish(plan)

    def _trigger(self, done: str, _: Any, response: Any) -> Any:
        response.success, response.message = True, done
        return response


class Gripper(RobotPart):
    """A gripper with two fingers: their command, their state, and an action that moves them."""

    def __init__(self, serial: int) -> None:
        super().__init__("gripper", serial)
        self._state_publisher = self.create_publisher(JointState, "joint_states", 10)
        self._commands = self.create_publisher(JointState, "joint_commands", 10)
        # In meters.
        self._goal_position = self._is = 0.0
        self._server = ActionServer(self, GripperCommand, "gripper_cmd", self._move)
        self.create_timer(0.1, self._report)

    def _report(self) -> None:
        self._is += 0.4 * (self._goal_position - self._is)
        for publisher, position in ((self._state_publisher, self._is), (self._commands, self._goal_position)):
            state = JointState(name=["finger_joint"], position=[position])
            state.header.stamp = self.get_clock().now().to_msg()
            publisher.publish(state)

    def _move(self, goal: Any) -> Any:
        self._goal_position = goal.request.command.position
        goal.succeed()
        return GripperCommand.Result(position=self._goal_position, reached_goal=True)


class Board(RobotPart):
    """Publishes measurements of the computer once per second."""

    def __init__(self, serial: int) -> None:
        super().__init__("board", serial)
        add = partial(self.create_publisher, qos_profile=10)
        self._battery_publisher = add(BatteryState, "battery")
        self._temperature = add(Temperature, "motor_temperature")
        self._load, self._accuracy = add(Float64, "load"), add(Float64, "detector/accuracy")
        self._start_ns = self.get_clock().now().nanoseconds
        self.create_timer(1.0, self._measure)

    def _measure(self) -> None:
        now = self.get_clock().now()
        seconds = (now.nanoseconds - self._start_ns) * 1e-9
        battery = BatteryState(percentage=max(0.05, 0.32 - 0.0005 * seconds))
        # In degrees Celsius.
        warmth = Temperature(temperature=75.0 - 40.0 * math.exp(-seconds / 20.0))
        battery.header.stamp = warmth.header.stamp = now.to_msg()
        self._battery_publisher.publish(battery)
        self._temperature.publish(warmth)
        self._load.publish(Float64(data=0.5 + 0.2 * math.sin(seconds)))
        self._accuracy.publish(Float64(data=0.92))


class SafetyStop(RobotPart):
    """Publishes whether the robot must stop before a wall, if it receives the scans."""

    def __init__(self, serial: int) -> None:
        super().__init__("safety_stop", serial)
        self._stops = self.create_publisher(Bool, "stop", 10)
        self.create_subscription(LaserScan, "scan", self._on_scan, qos_profile_sensor_data if serial else 10)

    def _on_scan(self, scan: LaserScan) -> None:
        self._stops.publish(Bool(data=min(scan.ranges) < 0.5))


def unknown_robot(serial: int = 0) -> list[Node]:
    """Return the nodes of the robot that students explore in week 6.

    Args:
        serial: The serial number, which determines the facts about the robot.
    """
    kinds = (CameraDriver, BoxDetector, LidarDriver, BaseDriver, Gripper, Board, SafetyStop)
    return [kind(serial) for kind in kinds]


def robot_pose(node: Node) -> tuple[float, float, float]:
    """Return x, y [m] and yaw [rad] of the robot in odom."""
    angle = math.remainder(TURN * node.get_clock().now().nanoseconds * 1e-9, math.tau)
    return RADIUS * math.cos(angle), RADIUS * math.sin(angle), angle + math.pi / 2


def stamped_transform(
    node: Node, parent: str, child: str, x: float, y: float = 0.0, yaw: float = 0.0
) -> TransformStamped:
    """Return the message of a transform from child to parent, stamped with the current time."""
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id, message.header.stamp = parent, node.get_clock().now().to_msg()
    message.transform.translation.x, message.transform.translation.y = x, y
    message.transform.rotation.z, message.transform.rotation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return message


def main() -> None:
    """Run the robot until Ctrl+C, in several threads so that no node blocks another."""
    import rclpy
    from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor

    rclpy.init()
    executor, nodes = MultiThreadedExecutor(), unknown_robot()
    for node in nodes:
        executor.add_node(node)
    nodes[0].get_logger().info("The robot is ready. Explore it.")
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


if __name__ == "__main__":
    main()
