"""Right answers to week 3 that look nothing like ours: one class draws, and DELETE for each."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from geometry_msgs.msg import Point, Vector3
from rclpy.duration import Duration
from rclpy.node import Node
from std_msgs.msg import ColorRGBA
from vision_msgs.msg import Detection3DArray
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.grading import my_values

RED, GREEN = np.array([1.0, 0.0, 0.0, 0.5]), np.array([0.0, 1.0, 0.0, 0.5])


def confidence_color(confidence: float) -> Any:
    mixed = (1 - confidence) * RED + confidence * GREEN
    return np.round(mixed, 9)


class Drawer(Node):
    """Draws each detection with `draw`, with the header of its message."""

    def __init__(self) -> None:
        super().__init__(type(self).__name__.lower())
        self.create_subscription(Detection3DArray, "objects", self.receive, 1)
        self.out = self.create_publisher(MarkerArray, "detections", 1)
        self.known: dict[int, Any] = {}

    def receive(self, message: Detection3DArray) -> None:
        """Draw all that came."""
        array = MarkerArray()
        for detection in message.detections:
            for marker in self.draw(detection, message):
                marker.id = int(detection.id)
                marker.header = message.header
                array.markers.append(marker)
        array.markers.extend(self.gone(message))
        self.out.publish(array)

    def draw(self, detection: Any, message: Detection3DArray) -> Iterator[Marker]:
        """The markers of one detection."""
        raise NotImplementedError

    def gone(self, message: Detection3DArray) -> list[Marker]:
        """Markers that delete what was not drawn again."""
        return []


def cube(detection: Any, lifetime: float) -> Marker:
    red, green, blue, alpha = map(float, confidence_color(detection.results[0].hypothesis.score))
    return Marker(
        type=Marker.CUBE,
        ns="boxes",
        pose=detection.bbox.center,
        scale=detection.bbox.size,
        color=ColorRGBA(r=red, g=green, b=blue, a=alpha),
        lifetime=Duration(seconds=lifetime).to_msg(),
    )


class BoxNode(Drawer):
    def draw(self, detection: Any, message: Detection3DArray) -> Iterator[Marker]:
        yield cube(detection, 1.0)


class LabelNode(Drawer):
    def draw(self, detection: Any, message: Detection3DArray) -> Iterator[Marker]:
        best = max(detection.results, key=lambda result: result.hypothesis.score).hypothesis
        marker = Marker(type=Marker.TEXT_VIEW_FACING, ns="labels")
        marker.pose.position = detection.bbox.center.position
        marker.pose.position.z += 0.5 + 0.5 * detection.bbox.size.z
        marker.text = "{} ({:4.2f})".format(best.class_id, best.score)  # noqa: UP032 - another way to write it
        marker.scale = Vector3(z=my_values("week03.labels")["letters"])
        marker.color = ColorRGBA(r=1.0, g=1.0, b=1.0, a=1.0)
        marker.lifetime.sec = 1
        yield marker


class SureBoxNode(Drawer):
    def draw(self, detection: Any, message: Detection3DArray) -> Iterator[Marker]:
        if not detection.results[0].hypothesis.score < my_values("week03.sure_boxes")["threshold"]:
            self.known[int(detection.id)] = message.header.stamp
            yield cube(detection, 0.0)

    def gone(self, message: Detection3DArray) -> list[Marker]:
        old = [number for number, stamp in self.known.items() if stamp != message.header.stamp]
        for number in old:
            del self.known[number]
        return [Marker(ns="boxes", id=number, action=Marker.DELETE) for number in old]


class VelocityNode(Drawer):
    def draw(self, detection: Any, message: Detection3DArray) -> Iterator[Marker]:
        p, stamp = detection.bbox.center.position, message.header.stamp
        here = np.array([p.x, p.y, p.z, stamp.sec % 1000 + stamp.nanosec * 1e-9])
        before = self.known.get(int(detection.id))
        self.known[int(detection.id)] = here
        if before is not None:
            step = here - before
            ahead = here[:3] + step[:3] / step[3]
            marker = Marker(
                type=Marker.ARROW,
                ns="velocities",
                points=[p, Point(**dict(zip("xyz", ahead.tolist(), strict=True)))],
            )
            marker.scale = Vector3(x=0.08, y=0.2)
            marker.color = ColorRGBA(b=1.0, a=1.0)
            yield marker
