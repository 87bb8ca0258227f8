"""Week 7, another right solution."""

from typing import Any

import numpy as np
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import Path
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import Buffer, TransformException, TransformListener
from vision_msgs.msg import Detection3DArray
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.grading import my_values

COLORS = {"car_color": [1.0, 0.0, 0.0, 0.5], "person_color": [0.0, 1.0, 0.0, 0.5]}
DEFAULTS = {"marker_lifetime": 1.0, "confidence_threshold": 0.5, "max_detections": 20, **COLORS}


def box_on_image(k: Any, corners: Any) -> Any:
    """With arrays."""
    points = np.array(corners).T
    if points[2].min() < 0.1:  # [m]
        return []
    pixels = np.array(k).reshape(3, 3) @ points
    pixels = pixels[:2] / pixels[2]
    return np.concatenate([pixels.min(axis=1), pixels.max(axis=1)])


class PerceptionNode(Node):
    """Without the base class, and boxes only."""

    def __init__(self) -> None:
        super().__init__("perception_node")
        self.declare_parameters("", list(DEFAULTS.items()))
        self.detections = Detection3DArray()
        self.publisher = self.create_publisher(MarkerArray, "/perception/markers", 10)
        self.create_subscription(Detection3DArray, "/objects", self.keep, 10)
        self.create_timer(0.1, self.publish_markers)  # [s]

    def keep(self, message: Detection3DArray) -> None:
        self.detections = message

    def publish_markers(self) -> None:
        lifetime = Duration(seconds=self.get_parameter("marker_lifetime").value)
        array, found = MarkerArray(), list(self.detections.detections)
        found.sort(key=lambda one: -one.results[0].hypothesis.score)
        if self.get_clock().now() - Time.from_msg(self.detections.header.stamp) > lifetime:
            found = []
        for detection in found[: self.get_parameter("max_detections").value]:
            guess = detection.results[0].hypothesis
            if guess.score < self.get_parameter("confidence_threshold").value:
                continue
            marker = Marker(ns="boxes", id=int(detection.id), type=Marker.CUBE)
            marker.header, marker.lifetime = self.detections.header, lifetime.to_msg()
            marker.pose, marker.scale = detection.bbox.center, detection.bbox.size
            name = guess.class_id.lower() + "_color"
            known = self.get_parameter(name).value if name in DEFAULTS else [0.5] * 4
            for channel, value in zip("rgba", known, strict=True):
                setattr(marker.color, channel, value)
            array.markers.append(marker)
        self.publisher.publish(array)


class TrajectoryNode(Node):
    """By the exception, and a list that is shortened."""

    def __init__(self) -> None:
        super().__init__("trajectory_node")
        self.declare_parameters(
            "", [("world_frame", "world"), ("base_frame", "base_link"), ("trajectory_max_points", 100)]
        )
        self.buffer = Buffer()
        self.listener = TransformListener(self.buffer, self)
        self.path = Path()
        self.publisher = self.create_publisher(Path, "/robot_trajectory", 10)
        self.create_timer(0.1, self.update)  # [s]

    def update(self) -> None:
        world, base = (self.get_parameter(name).value for name in ("world_frame", "base_frame"))
        try:
            found = self.buffer.lookup_transform(world, base, Time())
        except TransformException:
            return
        pose = PoseStamped(header=found.header)
        pose.pose.position.x = found.transform.translation.x
        pose.pose.position.y = found.transform.translation.y
        pose.pose.position.z = found.transform.translation.z
        pose.pose.orientation = found.transform.rotation
        self.path.poses.append(pose)
        while len(self.path.poses) > self.get_parameter("trajectory_max_points").value:
            self.path.poses.pop(0)
        self.path.header.frame_id = world
        self.path.header.stamp = self.get_clock().now().to_msg()
        self.publisher.publish(self.path)


def robot_params() -> str:
    """Every node by its full name, with the frame in each."""
    threshold = my_values("week07.params")["threshold"]
    frame = "{ros__parameters: {world_frame: odom}}"
    return f"""
tf_publisher: {frame}
path_planner: {frame}
/perception_node:
  ros__parameters:
    world_frame: "odom"
    marker_update_rate: 5.
    confidence_threshold: {threshold}
    bicycle_color:
      - 1.0
      - 1.0
      - 0.0
      - 0.5
/trajectory_node: {{ros__parameters: {{trajectory_max_points: 50, world_frame: odom}}}}
"""


def dashboard_layout() -> str:
    """As somebody who knows YAML writes it."""
    return """
Visualization Manager:
  Global Options: {Fixed Frame: world}
  Displays:
    - Class: rviz_common/Group
      Name: Ways
      Displays:
        - {Class: rviz_default_plugins/Path, Color: 255; 0; 0, Topic: {Value: /robot_trajectory}}
        - {Class: rviz_default_plugins/Path, Color: 0; 200; 255, Topic: {Value: /planned_path}}
    - {Class: rviz_default_plugins/MarkerArray, Topic: {Value: /perception/markers}}
    - {Class: rviz_default_plugins/TF, Show Names: true}
  Views:
    Current: {Class: rviz_default_plugins/TopDownOrtho}
"""


dashboard_report = "word " * 200


def part_ahead(a: Any, b: Any) -> Any:
    """With arrays, by clipping both ends' shares."""
    start, end = np.array(a), np.array(b)
    if max(start[2], end[2]) < 0.1:  # [m]
        return []
    rise = end[2] - start[2]
    share = (0.1 - start[2]) / rise if rise else 0.0
    low = share if start[2] < 0.1 else 0.0
    high = share if end[2] < 0.1 else 1.0
    return [start + low * (end - start), start + high * (end - start)]
