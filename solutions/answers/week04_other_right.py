"""Right answers to week 4 that look nothing like ours: complex numbers, time instead of counting."""

import numpy as np
import tf2_geometry_msgs
from geometry_msgs.msg import PointStamped, Quaternion, Transform, TransformStamped, Vector3
from numpy.typing import ArrayLike, NDArray
from rclpy.node import Node
from rclpy.time import Time
from std_msgs.msg import Header
from tf2_ros import (
    Buffer,
    StaticTransformBroadcaster,
    TransformBroadcaster,
    TransformException,
    TransformListener,
)
from tf_transformations import quaternion_from_euler

from course_lib.grading import my_values


def point_to_world(point: ArrayLike, x: float, y: float, yaw: float) -> NDArray[np.float64]:
    turn = np.exp(1j * yaw) * complex(*np.asarray(point, float)[:2]) + complex(x, y)
    return np.array([turn.real, turn.imag, np.asarray(point, float)[2]])


class Frames(Node):
    """Broadcasts poses that depend on the time since the start."""

    fixed: tuple[tuple[str, str, tuple[float, ...]], ...] = ()
    period = 0.02

    def __init__(self) -> None:
        super().__init__(type(self).__name__.lower())
        self.start = self.get_clock().now()
        self.moving, self.static = TransformBroadcaster(self), StaticTransformBroadcaster(self)
        self.static.sendTransform([self.made(parent, child, *pose) for parent, child, pose in self.fixed])
        self.create_timer(self.period, self.move)

    def seconds(self) -> float:
        return float((self.get_clock().now() - self.start).nanoseconds) / 1e9

    def made(self, parent: str, child: str, x: float, y: float, z: float, yaw: float) -> TransformStamped:
        qx, qy, qz, qw = map(float, quaternion_from_euler(0.0, 0.0, yaw))
        place, turn = Vector3(x=x, y=y, z=z), Quaternion(x=qx, y=qy, z=qz, w=qw)
        header = Header(frame_id=parent, stamp=self.get_clock().now().to_msg())
        transform = Transform(translation=place, rotation=turn)
        return TransformStamped(header=header, child_frame_id=child, transform=transform)

    def move(self) -> None:
        """Broadcast what moves."""
        raise NotImplementedError


class RobotFramesNode(Frames):
    fixed = (("base_link", "camera_link", (0.2, 0.0, 0.6, 0.0)),)

    def move(self) -> None:
        angle = 2 * np.pi * self.seconds() / 8.0
        out = my_values("week04.robot_frames")["radius"] * np.exp(1j * angle)
        pose = (float(out.real), float(out.imag), 0.0, float(np.angle(1j * out)))
        self.moving.sendTransform(self.made("map", "base_link", *pose))


class MendedArm(Frames):
    period = 0.05
    fixed = (
        ("hand_link", "finger_link", (0.1, 0.0, 0.0, 0.0)),
        ("base_link", "arm_link", (0.0, 0.0, 1.0, 0.0)),
        ("map", "base_link", (0.0, 0.0, 0.2, 0.0)),
    )

    def move(self) -> None:
        self.moving.sendTransform(self.made("arm_link", "hand_link", 0.4, 0.0, 0.0, 0.5 * self.seconds()))


class ObstacleNode(Node):
    def __init__(self) -> None:
        super().__init__("carrier")
        self.tf = Buffer()
        TransformListener(self.tf, self)
        self.out = self.create_publisher(PointStamped, "obstacle_in_map", 1)
        self.create_subscription(PointStamped, "obstacle", self.take, 10)

    def take(self, message: PointStamped) -> None:
        seen = Time.from_msg(message.header.stamp)
        try:
            found = self.tf.lookup_transform("map", message.header.frame_id, seen)
        except TransformException:
            return
        self.out.publish(tf2_geometry_msgs.do_transform_point(message, found))


def in_between(first: ArrayLike, second: ArrayLike, ratio: float) -> NDArray[np.float64]:
    a, b = np.asarray(first, float), np.asarray(second, float)
    turn = np.angle(np.exp(1j * (b[2] - a[2])))
    return a + ratio * np.array([*(b - a)[:2], turn])
