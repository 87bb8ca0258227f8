"""turtle_tf2_py: the nodes of tf2's tutorials, which give turtles frames and let one follow a frame."""

import math

from geometry_msgs.msg import TransformStamped, Twist
from rclpy.node import Node
from rclpy.task import Future
from rclpy.time import Time
from tf2_ros import (
    Buffer,
    StaticTransformBroadcaster,
    TransformBroadcaster,
    TransformException,
    TransformListener,
)
from tf_transformations import quaternion_from_euler
from turtlesim.msg import Pose
from turtlesim.srv import Spawn

from course_lib.errors import CourseError

# Gains of the follower: forward speed by distance, turning speed by bearing [1/s].
FORWARD_GAIN, TURNING_GAIN = 0.5, 1.0
# Periods of the follower and of the broadcasters of carrot1 [s].
FOLLOW_PERIOD, CARROT_PERIOD = 1.0, 0.1
# Distances of carrot1 from its turtle: attached to it, and circling around it [m].
FIXED_DISTANCE, RADIUS = 2.0, 10.0


class TurtleBroadcaster(Node):
    """Broadcasts the frame of the turtle that the parameter `turtlename` names."""

    def __init__(self) -> None:
        super().__init__("turtle_tf2_frame_publisher")
        self._turtle = self.declare_parameter("turtlename", "turtle").value
        self._broadcaster = TransformBroadcaster(self)
        self.create_subscription(Pose, f"/{self._turtle}/pose", self._on_pose, 1)

    def _on_pose(self, pose: Pose) -> None:
        at = (pose.x, pose.y, 0.0)
        self._broadcaster.sendTransform(_transform(self, "world", self._turtle, at, (0.0, 0.0, pose.theta)))


class FixedFrameBroadcaster(Node):
    """Broadcasts the frame carrot1, which is attached to the first turtle."""

    def __init__(self) -> None:
        super().__init__("fixed_frame_tf2_broadcaster")
        self._broadcaster = TransformBroadcaster(self)
        self.create_timer(CARROT_PERIOD, self._broadcast)

    def _broadcast(self) -> None:
        self._broadcaster.sendTransform(_transform(self, "turtle1", "carrot1", (0.0, FIXED_DISTANCE, 0.0)))


class DynamicFrameBroadcaster(Node):
    """Broadcasts the frame carrot1, which circles around the first turtle every two seconds."""

    def __init__(self) -> None:
        super().__init__("dynamic_frame_tf2_broadcaster")
        self._broadcaster = TransformBroadcaster(self)
        self.create_timer(CARROT_PERIOD, self._broadcast)

    def _broadcast(self) -> None:
        seconds = self.get_clock().now().seconds_nanoseconds()[0]
        angle = math.pi * seconds
        at = (RADIUS * math.sin(angle), RADIUS * math.cos(angle), 0.0)
        self._broadcaster.sendTransform(_transform(self, "turtle1", "carrot1", at))


class StaticTurtleBroadcaster(Node):
    """Broadcasts a static frame once: its name, its position and its roll, pitch and yaw are arguments."""

    def __init__(self, words: list[str]) -> None:
        if len(words) != 7:
            raise CourseError(
                "Invalid number of parameters. Usage: ros2 run turtle_tf2_py static_turtle_tf2_broadcaster "
                "child_frame_name x y z roll pitch yaw"
            )
        frame, *numbers = words
        if frame == "world":
            raise CourseError('Your static turtle name cannot be "world"')
        super().__init__("static_turtle_tf2_broadcaster")
        x, y, z, roll, pitch, yaw = map(float, numbers)
        self._broadcaster = StaticTransformBroadcaster(self)
        self._broadcaster.sendTransform(_transform(self, "world", frame, (x, y, z), (roll, pitch, yaw)))


class TurtleFollower(Node):
    """Spawns the second turtle, which follows the frame that the parameter `target_frame` names."""

    def __init__(self) -> None:
        super().__init__("turtle_tf2_frame_listener")
        self._target = self.declare_parameter("target_frame", "turtle1").value
        self._buffer = Buffer()
        self._listener = TransformListener(self._buffer, self)
        self._spawner = self.create_client(Spawn, "spawn")
        self._spawned: Future[Spawn.Response] | None = None
        self._twists = self.create_publisher(Twist, "turtle2/cmd_vel", 1)
        self.create_timer(FOLLOW_PERIOD, self._follow)

    def _follow(self) -> None:
        if self._spawned is None:
            self._spawn()
        elif not self._spawned.done():
            self.get_logger().info("Spawn is not finished")
        else:
            self._drive()

    def _spawn(self) -> None:
        if self._spawner.service_is_ready():
            self._spawned = self._spawner.call_async(Spawn.Request(name="turtle2", x=4.0, y=2.0))
        else:
            self.get_logger().info("Service is not ready")

    def _drive(self) -> None:
        try:
            transform = self._buffer.lookup_transform("turtle2", self._target, Time())
        except TransformException as error:
            self.get_logger().info(f"Could not transform turtle2 to {self._target}: {error}")
            return
        x, y = transform.transform.translation.x, transform.transform.translation.y
        twist = Twist()
        twist.linear.x = FORWARD_GAIN * math.hypot(x, y)
        twist.angular.z = TURNING_GAIN * math.atan2(y, x)
        self._twists.publish(twist)


def _transform(
    node: Node,
    parent: str,
    child: str,
    at: tuple[float, float, float],
    angles: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> TransformStamped:
    """Return a transform with the current time; `at` in m, `angles` are roll, pitch and yaw in rad."""
    transform = TransformStamped(child_frame_id=child)
    transform.header.stamp = node.get_clock().now().to_msg()
    transform.header.frame_id = parent
    translation, rotation = transform.transform.translation, transform.transform.rotation
    translation.x, translation.y, translation.z = at
    rotation.x, rotation.y, rotation.z, rotation.w = map(float, quaternion_from_euler(*angles))
    return transform
