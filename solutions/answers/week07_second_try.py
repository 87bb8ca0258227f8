"""Week 7, wrong answers of a second try."""

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
from course_lib.grading import my_values


def box_on_image(k: Any, corners: Any) -> Any:
    """Only the nearest corner and the farthest one."""
    if any(z < 0.1 for _, _, z in corners):  # [m]
        return []
    (left, top), (right, bottom) = (
        (k[0] * x / z + k[2], k[4] * y / z + k[5]) for x, y, z in (corners[0], corners[-1])
    )
    return [left, top, right, bottom]


class PerceptionNode(Node):
    """Draws the first ones, not the best, and shows them for ever when the detector has died."""

    def __init__(self) -> None:
        super().__init__("perception_node")
        self.declare_parameters("", [("confidence_threshold", 0.5), ("max_detections", 20)])
        self.declare_parameters("", [("person_color", [0.0, 1.0, 0.0, 0.5])])
        self.declare_parameters("", [("car_color", [1.0, 0.0, 0.0, 0.5])])
        self.detections = Detection3DArray()
        self.publisher = self.create_publisher(MarkerArray, "/perception/markers", 10)
        self.create_subscription(Detection3DArray, "/objects", self.keep, 10)
        self.create_timer(0.1, self.publish_markers)  # [s]

    def keep(self, message: Detection3DArray) -> None:
        self.detections = message

    def publish_markers(self) -> None:
        array, threshold = MarkerArray(), self.get_parameter("confidence_threshold").value
        sure = [d for d in self.detections.detections if d.results[0].hypothesis.score >= threshold]
        for detection in sure[: self.get_parameter("max_detections").value]:
            marker = Marker(ns="boxes", id=int(detection.id), type=Marker.CUBE)
            marker.header = self.detections.header
            marker.lifetime = Duration(seconds=1.0).to_msg()
            marker.pose, marker.scale = detection.bbox.center, detection.bbox.size
            key = f"{detection.results[0].hypothesis.class_id.lower()}_color"
            color = self.get_parameter(key).value if self.has_parameter(key) else [0.5] * 4
            marker.color.r, marker.color.g, marker.color.b, marker.color.a = color
            array.markers.append(marker)
        self.publisher.publish(array)


class TrajectoryNode(Node):
    """Without the orientation, and the world seen from the robot."""

    def __init__(self) -> None:
        super().__init__("trajectory_node")
        self.declare_parameters("", [("world_frame", "world"), ("base_frame", "base_link")])
        self.declare_parameter("trajectory_max_points", 100)
        self.buffer, self.poses = Buffer(), list[PoseStamped]()
        self.listener = TransformListener(self.buffer, self)
        self.publisher = self.create_publisher(Path, "/robot_trajectory", 10)
        self.create_timer(0.1, self.update)  # [s]

    def update(self) -> None:
        world, base = (self.get_parameter(name).value for name in ("world_frame", "base_frame"))
        if self.buffer.can_transform(base, world, Time()):
            found = self.buffer.lookup_transform(base, world, Time())
            pose = PoseStamped(header=found.header)
            pose.pose.position.x = found.transform.translation.x
            pose.pose.position.y = found.transform.translation.y
            pose.pose.position.z = found.transform.translation.z
            self.poses = [*self.poses, pose][-self.get_parameter("trajectory_max_points").value :]
            path = Path(poses=self.poses)
            path.header.frame_id, path.header.stamp = world, found.header.stamp
            self.publisher.publish(path)


def robot_params() -> str:
    """An integer for a rate."""
    threshold = my_values("week07.params")["threshold"]
    return f"""
/**:
  ros__parameters:
    world_frame: odom
perception_node:
  ros__parameters:
    marker_update_rate: 5
    confidence_threshold: {threshold}
    bicycle_color: [1.0, 1.0, 0.0, 0.5]
trajectory_node:
  ros__parameters:
    trajectory_max_points: 50
"""


def dashboard_layout() -> str:
    """One path is forgotten, and so are the names."""
    made = Viewer(fixed_frame="base_link")
    made.add("TF")
    made.add("MarkerArray", "/perception/markers")
    made.add("Path", "/planned_path", color="25; 255; 0")
    made.save_rviz("dashboard.rviz")
    return File("dashboard.rviz").read_text()


dashboard_report = ""


def part_ahead(a: Any, b: Any) -> Any:
    """The cut comes first, always."""
    if a[2] < 0.1 and b[2] < 0.1:  # [m]
        return []
    if a[2] >= 0.1 and b[2] >= 0.1:
        return [a, b]
    share = (0.1 - a[2]) / (b[2] - a[2])
    cut = [m + share * (n - m) for m, n in zip(a, b, strict=True)]
    return [cut, a if a[2] >= 0.1 else b]
