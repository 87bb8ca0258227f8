"""Publishes what a detector finds."""

import numpy as np
from geometry_msgs.msg import Point, Vector3
from rclpy.node import Node
from std_msgs.msg import Header
from vision_msgs.msg import Detection3D, Detection3DArray, ObjectHypothesisWithPose

from course_lib.ros.clock import START_NS
from course_lib.sensors.checked import Floats, check_number
from course_lib.sensors.detector import Detection, Detector


class DetectorNode(Node):
    """Publishes vision_msgs/Detection3DArray.

    Args:
        detector: Where detections come from.
        frame_id: The world's frame, in which boxes are given.
    """

    def __init__(
        self,
        detector: Detector,
        *,
        name: str = "detector",
        topic: str = "objects",
        frame_id: str = "map",
        rate: float = 2.0,  # [Hz]
    ) -> None:
        self.detector, self.frame_id = detector, frame_id
        period = 1 / check_number("rate [Hz]", rate, above=0)
        super().__init__(name)
        self.publisher = self.create_publisher(Detection3DArray, topic, 10)
        self.timer = self.create_timer(period, self.publish_detections)

    def publish_detections(self) -> None:
        """Detect now and publish."""
        now = self.get_clock().now()
        header = Header(stamp=now.to_msg(), frame_id=self.frame_id)
        found = self.detector.detect((now.nanoseconds - START_NS) * 1e-9)
        detections = [detection_message(detection, header) for detection in found]
        self.publisher.publish(Detection3DArray(header=header, detections=detections))


def detection_message(detection: Detection, header: Header) -> Detection3D:
    """Write a detection as a message; it has one hypothesis, and its track is the id."""
    message = Detection3D(header=header, id=str(detection.track))
    _write(message.bbox.center.position, detection.transform_box_to_world[:3, 3])
    for axis, value in zip("xyzw", quaternion(detection.transform_box_to_world[:3, :3]), strict=True):
        setattr(message.bbox.center.orientation, axis, value)
    _write(message.bbox.size, detection.size)
    hypothesis = ObjectHypothesisWithPose()
    hypothesis.hypothesis.class_id = detection.label
    hypothesis.hypothesis.score = float(detection.confidence)
    hypothesis.pose.pose = message.bbox.center
    message.results = [hypothesis]
    return message


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


def _write(vector: Vector3 | Point, values: Floats) -> None:
    vector.x, vector.y, vector.z = map(float, values)
