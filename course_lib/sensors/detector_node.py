"""Publishes what a detector finds."""

from geometry_msgs.msg import Point, Vector3
from rclpy.node import Node
from std_msgs.msg import Header
from transforms3d.quaternions import mat2quat
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
    w, x, y, z = map(float, mat2quat(rotation))
    return x, y, z, w


def _write(vector: Vector3 | Point, values: Floats) -> None:
    vector.x, vector.y, vector.z = map(float, values)
