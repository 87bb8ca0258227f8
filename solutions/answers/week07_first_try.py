"""Week 7, wrong answers of a first try."""

from pathlib import Path as File
from typing import Any

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import Buffer, TransformListener
from vision_msgs.msg import Detection3DArray
from visualization_msgs.msg import Marker, MarkerArray

from course_lib import Viewer


def box_on_image(k: Any, corners: Any) -> Any:
    """Height is up, as on paper; what is behind the camera is drawn upside down."""
    columns = [k[0] * x / z + k[2] for x, _, z in corners]
    rows = [k[5] - k[4] * y / z for _, y, z in corners]
    return [min(columns), min(rows), max(columns), max(rows)]


class PerceptionNode(Node):
    """Reads its parameters once."""

    def __init__(self) -> None:
        super().__init__("perception_node")
        self.declare_parameters("", [("confidence_threshold", 0.5), ("max_detections", 20)])
        self.declare_parameter("car_color", [1.0, 0.0, 0.0, 0.5])
        self.threshold = self.get_parameter("confidence_threshold").value
        self.most = self.get_parameter("max_detections").value
        self.detections = Detection3DArray()
        self.publisher = self.create_publisher(MarkerArray, "/perception/markers", 10)
        self.create_subscription(Detection3DArray, "/objects", self.keep, 10)
        self.create_timer(0.1, self.publish_markers)  # [s]

    def keep(self, message: Detection3DArray) -> None:
        self.detections = message

    def publish_markers(self) -> None:
        array = MarkerArray()
        for detection in self.detections.detections[: self.most]:
            if detection.results[0].hypothesis.score >= self.threshold:
                marker = Marker(ns="boxes", id=int(detection.id), type=Marker.CUBE)
                marker.header = self.detections.header
                marker.lifetime = Duration(seconds=1.0).to_msg()
                marker.pose, marker.scale = detection.bbox.center, detection.bbox.size
                marker.color.g, marker.color.a = 1.0, 0.5
                array.markers.append(marker)
        self.publisher.publish(array)


class TrajectoryNode(Node):
    """Never forgets."""

    def __init__(self) -> None:
        super().__init__("trajectory_node")
        self.declare_parameters("", [("world_frame", "world"), ("base_frame", "base_link")])
        self.declare_parameter("trajectory_max_points", 100)
        self.buffer, self.path = Buffer(), Path()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(Path, "/robot_trajectory", 10)
        self.create_timer(0.1, self.update)  # [s]

    def update(self) -> None:
        if self.buffer.can_transform("world", "base_link", Time()):
            found = self.buffer.lookup_transform("world", "base_link", Time())
            pose = PoseStamped(header=found.header)
            pose.pose.position.x = found.transform.translation.x
            pose.pose.position.y = found.transform.translation.y
            self.path.poses.append(pose)
            self.path.header = found.header
            self.publisher.publish(self.path)


def robot_params() -> str:
    """Without ros__parameters."""
    return """
perception_node:
  world_frame: odom
  marker_update_rate: 5.0
trajectory_node:
  trajectory_max_points: 50
"""


def dashboard_layout() -> str:
    """Both paths in the color they come with."""
    made = Viewer(fixed_frame="world")
    made.add("TF", show_names=True)
    made.add("MarkerArray", "/perception/markers")
    made.add("Path", "/planned_path")
    made.add("Path", "/robot_trajectory")
    made.save_rviz("dashboard.rviz")
    return File("dashboard.rviz").read_text()


dashboard_report = "It works."


def part_ahead(a: Any, b: Any) -> Any:
    """All or nothing."""
    return [] if min(a[2], b[2]) < 0.1 else [a, b]
