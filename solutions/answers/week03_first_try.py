"""Answers to week 3 as students write them at first: each of the five is wrong in its own way."""

from typing import Any

from geometry_msgs.msg import Point
from rclpy.duration import Duration
from rclpy.node import Node
from vision_msgs.msg import Detection3DArray
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.grading import my_values


def confidence_color(confidence: float) -> tuple[float, float, float, float]:
    """Mistake: red is sure."""
    return confidence, 1.0 - confidence, 0.0, 0.5


class DetectionNode(Node):
    """Base of the four nodes."""

    def __init__(self) -> None:
        super().__init__("first_try")
        self.publisher = self.create_publisher(MarkerArray, "/detections", 10)
        self.create_subscription(Detection3DArray, "/objects", self.draw, 10)
        self.before: dict[str, Any] = {}

    def draw(self, message: Detection3DArray) -> None:
        """Publish what the task asks for."""
        markers = [marker for detection in message.detections for marker in self.markers(detection)]
        for marker in markers:
            marker.header = message.header
        self.publisher.publish(MarkerArray(markers=markers))

    def markers(self, detection: Any) -> list[Marker]:
        """The markers of one detection."""
        raise NotImplementedError

    def box(self, detection: Any) -> Marker:
        """A right box."""
        score = detection.results[0].hypothesis.score
        marker = Marker(ns="boxes", id=int(detection.id), type=Marker.CUBE)
        marker.pose = detection.bbox.center
        marker.scale = detection.bbox.size
        marker.color.r, marker.color.g, marker.color.a = 1.0 - score, score, 0.5
        return marker


class BoxNode(DetectionNode):
    """All boxes have the id 0: only the last one stays."""

    def markers(self, detection: Any) -> list[Marker]:
        marker = self.box(detection)
        marker.id = 0
        marker.lifetime = Duration(seconds=1.0).to_msg()
        return [marker]


class LabelNode(DetectionNode):
    """Measures from the centre of the box."""

    def markers(self, detection: Any) -> list[Marker]:
        found, center = detection.results[0].hypothesis, detection.bbox.center.position
        marker = Marker(ns="labels", id=int(detection.id), type=Marker.TEXT_VIEW_FACING)
        marker.text = f"{found.class_id} ({found.score:.2f})"
        marker.pose.position.x, marker.pose.position.y = center.x, center.y
        marker.pose.position.z = center.z + 0.5
        marker.scale.z = my_values("week03.labels")["letters"]
        marker.color.r = marker.color.g = marker.color.b = marker.color.a = 1.0
        return [marker]


class SureBoxNode(DetectionNode):
    """Leaves out what is unsure, but never removes anything."""

    def markers(self, detection: Any) -> list[Marker]:
        sure = detection.results[0].hypothesis.score >= my_values("week03.sure_boxes")["threshold"]
        return [self.box(detection)] if sure else []


class VelocityNode(DetectionNode):
    """Forgets to divide by the time."""

    def markers(self, detection: Any) -> list[Marker]:
        at = detection.bbox.center.position
        old = self.before.get(detection.id)
        self.before[detection.id] = at
        if old is None:
            return []
        marker = Marker(ns="velocities", id=int(detection.id), type=Marker.ARROW)
        marker.points = [at, Point(x=2 * at.x - old.x, y=2 * at.y - old.y, z=at.z)]
        marker.scale.x, marker.scale.y = 0.08, 0.2
        marker.color.b = marker.color.a = 1.0
        return [marker]
