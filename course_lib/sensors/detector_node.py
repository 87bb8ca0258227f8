"""Publishes detections as markers: boxes, labels, velocity arrows."""

from collections.abc import Iterator

import numpy as np
from geometry_msgs.msg import Point
from rclpy.duration import Duration
from rclpy.node import Node
from std_msgs.msg import Header
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.ros.clock import START_NS
from course_lib.sensors.checked import Floats, check_number
from course_lib.sensors.detector import Detection, Detector

_SLOW = 0.05  # [m/s] below it there is no arrow


class DetectorNode(Node):
    """Publishes visualization_msgs/MarkerArray: per detection a box, a label and, if it moves, an arrow.

    Args:
        detector: Where detections come from.
        threshold: Detections with less confidence are left out.
        frame_id: The world's frame, in which boxes are given.
        lifetime: How long markers stay, [s].
    """

    def __init__(
        self,
        detector: Detector,
        *,
        name: str = "detector",
        topic: str = "detections",
        threshold: float = 0.0,
        frame_id: str = "map",
        rate: float = 2.0,  # [Hz]
        lifetime: float = 1.0,
    ) -> None:
        self.detector, self.frame_id = detector, frame_id
        self.threshold = check_number("threshold", threshold, low=0, high=1)
        self.lifetime = Duration(seconds=check_number("lifetime [s]", lifetime, low=0)).to_msg()
        period = 1 / check_number("rate [Hz]", rate, above=0)
        super().__init__(name)
        self.publisher = self.create_publisher(MarkerArray, topic, 10)
        self.timer = self.create_timer(period, self.publish_detections)

    def publish_detections(self) -> None:
        """Detect now and publish."""
        now = self.get_clock().now()
        header = Header(stamp=now.to_msg(), frame_id=self.frame_id)
        found = self.detector.detect((now.nanoseconds - START_NS) * 1e-9)
        chosen = [detection for detection in found if detection.confidence >= self.threshold]
        markers = [marker for detection in chosen for marker in markers_of(detection)]
        for marker in markers:
            marker.header, marker.lifetime = header, self.lifetime
        self.publisher.publish(MarkerArray(markers=markers))


def markers_of(detection: Detection) -> Iterator[Marker]:
    """Draw a detection, the redder the less sure; header and lifetime are the caller's."""
    place = detection.transform_box_to_world[:3, 3]
    sure = float(detection.confidence)
    box = Marker(ns="boxes", id=detection.track, type=Marker.CUBE)
    _place(box, place, detection.size)
    turn = quaternion(detection.transform_box_to_world[:3, :3])
    for axis, value in zip("xyzw", turn, strict=True):
        setattr(box.pose.orientation, axis, value)
    box.color.r, box.color.g, box.color.a = 1 - sure, sure, 0.5
    yield box
    label = Marker(ns="labels", id=detection.track, type=Marker.TEXT_VIEW_FACING)
    label.text = f"{detection.label} ({sure:.2f})"
    _place(label, place + np.array([0, 0, detection.size[2] / 2 + 0.5]), np.full(3, 0.3))  # [m] above the box
    label.color.r = label.color.g = label.color.b = label.color.a = 1.0
    yield label
    if np.linalg.norm(detection.velocity) > _SLOW:
        arrow = Marker(ns="velocities", id=detection.track, type=Marker.ARROW)
        _place(arrow, np.zeros(3), np.array([0.05, 0.1, 0.15]))  # [m] shaft, head, length of the head
        ends = (place, place + detection.velocity)  # where it will be in 1 s
        arrow.points = [Point(x=float(x), y=float(y), z=float(z)) for x, y, z in ends]
        arrow.color.b = arrow.color.a = 1.0
        yield arrow


def quaternion(rotation: Floats) -> tuple[float, ...]:
    """Turn a rotation, shape (3, 3), into a quaternion in the order x, y, z, w."""
    r = rotation
    square = np.array(  # 4 q q^T of which the largest column is taken, so that nothing cancels
        [
            [1 + r[0, 0] - r[1, 1] - r[2, 2], r[0, 1] + r[1, 0], r[0, 2] + r[2, 0], r[2, 1] - r[1, 2]],
            [r[0, 1] + r[1, 0], 1 - r[0, 0] + r[1, 1] - r[2, 2], r[1, 2] + r[2, 1], r[0, 2] - r[2, 0]],
            [r[0, 2] + r[2, 0], r[1, 2] + r[2, 1], 1 - r[0, 0] - r[1, 1] + r[2, 2], r[1, 0] - r[0, 1]],
            [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1], 1 + np.trace(r)],
        ]
    )
    column = square[:, np.diag(square).argmax()]
    x, y, z, w = column / np.linalg.norm(column)
    return float(x), float(y), float(z), float(w)


def _place(marker: Marker, position: Floats, scale: Floats) -> None:
    for axis, where, size in zip("xyz", position, scale, strict=True):
        setattr(marker.pose.position, axis, float(where))
        setattr(marker.scale, axis, float(size))
