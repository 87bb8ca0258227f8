"""Answers to week 3 with other mistakes."""

from typing import Any

from geometry_msgs.msg import Point
from rclpy.duration import Duration
from rclpy.node import Node
from vision_msgs.msg import Detection3DArray
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.grading import my_values


def confidence_color(confidence: float) -> tuple[float, float, float]:
    """Forgets alpha."""
    return 1.0 - confidence, confidence, 0.0


class DetectionNode(Node):
    """Base of the four nodes. Mistake: the frame is always base_link."""

    def __init__(self) -> None:
        super().__init__("second_try")
        self.publisher = self.create_publisher(MarkerArray, "/detections", 10)
        self.create_subscription(Detection3DArray, "/objects", self.draw, 10)
        self.before: dict[str, Any] = {}

    def draw(self, message: Detection3DArray) -> None:
        """Publish what the task asks for."""
        self.publish(message, [self.marker(detection) for detection in message.detections])

    def publish(self, message: Detection3DArray, markers: list[Marker]) -> None:
        """Stamp and publish."""
        for marker in markers:
            marker.header.stamp = message.header.stamp
            marker.header.frame_id = "base_link"
        self.publisher.publish(MarkerArray(markers=markers))

    def marker(self, detection: Any) -> Marker:
        """A right box, but for the frame."""
        score = detection.results[0].hypothesis.score
        marker = Marker(ns="boxes", id=int(detection.id), type=Marker.CUBE)
        marker.pose = detection.bbox.center
        marker.scale = detection.bbox.size
        marker.color.r, marker.color.g, marker.color.a = 1.0 - score, score, 0.5
        marker.lifetime = Duration(seconds=1.0).to_msg()
        return marker


class BoxNode(DetectionNode):
    """Nothing but the frame is wrong: only other inputs show it."""


class LabelNode(DetectionNode):
    """Writes per cent, with the lesson's height of letters."""

    def marker(self, detection: Any) -> Marker:
        found, center = detection.results[0].hypothesis, detection.bbox.center.position
        marker = Marker(ns="labels", id=int(detection.id), type=Marker.TEXT_VIEW_FACING)
        marker.text = f"{found.class_id} {100 * found.score:.0f}%"
        marker.pose.position.x, marker.pose.position.y = center.x, center.y
        marker.pose.position.z = center.z + detection.bbox.size.z / 2 + 0.5
        marker.scale.z = 0.3
        marker.color.r = marker.color.g = marker.color.b = marker.color.a = 1.0
        return marker


class SureBoxNode(DetectionNode):
    """Clears the view, but draws what is not sure enough."""

    def draw(self, message: Detection3DArray) -> None:
        threshold = my_values("week03.sure_boxes")["threshold"]
        unsure = [d for d in message.detections if d.results[0].hypothesis.score < threshold]
        boxes = [self.marker(detection) for detection in unsure]
        self.publish(message, [Marker(action=Marker.DELETEALL), *boxes])


class VelocityNode(DetectionNode):
    """Draws the way it came, backwards."""

    def draw(self, message: Detection3DArray) -> None:
        now = message.header.stamp.sec + message.header.stamp.nanosec / 1e9
        arrows = []
        for detection in message.detections:
            at = detection.bbox.center.position
            if detection.id in self.before:
                then, old = self.before[detection.id]
                marker = Marker(ns="velocities", id=int(detection.id), type=Marker.ARROW)
                steps = [(was - new) / (now - then) for was, new in ((old.x, at.x), (old.y, at.y))]
                marker.points = [at, Point(x=at.x + steps[0], y=at.y + steps[1], z=at.z)]
                marker.scale.x, marker.scale.y = 0.08, 0.2
                marker.color.b = marker.color.a = 1.0
                arrows.append(marker)
            self.before[detection.id] = now, at
        self.publish(message, arrows)
