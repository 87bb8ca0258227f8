"""A program with the topics, frames and nodes that the lessons' commands name."""

from contextlib import suppress
from typing import Any

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState, LaserScan
from tf2_ros import TransformBroadcaster
from trajectory_msgs.msg import JointTrajectory
from vision_msgs.msg import Detection3DArray
from visualization_msgs.msg import Marker, MarkerArray

TOPICS: dict[str, Any] = {
    "/joint_states": JointState,
    "/objects": Detection3DArray,
    "/scan": LaserScan,
    "/visualization_marker": Marker,
}


class World(Node):
    """Publishes on every topic, twenty times a second."""

    def __init__(self) -> None:
        super().__init__("world")
        self.declare_parameter("rate", 20.0)
        self.every = {kind: self.create_publisher(kind, topic, 10) for topic, kind in TOPICS.items()}
        self.markers = self.create_publisher(MarkerArray, "/perception/markers", 10)
        self.create_subscription(JointTrajectory, "/arm_controller/joint_trajectory", lambda _: None, 10)
        self.broadcaster = TransformBroadcaster(self)
        self.create_timer(1 / self.get_parameter("rate").value, self.publish)

    def publish(self) -> None:
        now = self.get_clock().now().to_msg()
        for kind, publisher in self.every.items():
            message = kind()
            message.header.frame_id, message.header.stamp = "camera_link", now
            publisher.publish(message)
        marker = Marker()
        marker.header.frame_id, marker.header.stamp = "camera_link", now
        self.markers.publish(MarkerArray(markers=[marker]))
        transform = TransformStamped(child_frame_id="camera_link")
        transform.header.frame_id, transform.header.stamp = "world", now
        self.broadcaster.sendTransform(transform)


def main() -> None:
    rclpy.init()
    executor = SingleThreadedExecutor()
    executor.add_node(World())
    with suppress(ExternalShutdownException):
        executor.spin()


if __name__ == "__main__":
    main()
