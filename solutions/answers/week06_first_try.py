"""Week 6, wrong answers of a first try."""

from itertools import pairwise
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Image

from course_lib import Viewer
from course_lib.grading import my_values


def robot_facts() -> dict[str, Any]:
    """The facts about the lesson's robot."""
    return {
        "image_rate": 30.0,
        "image_width": 64,
        "scan_reliability": "BEST_EFFORT",
        "threshold": 0.5,
        "trigger_service": "/robot/reset_odometry",
    }


class Camera(Node):
    """Reads the parameter once."""

    def __init__(self) -> None:
        super().__init__("camera")
        self.declare_parameter("frame_rate", my_values("week06.camera")["frame_rate"])
        self.declare_parameter("frame_id", "camera_link")
        self.publisher = self.create_publisher(Image, "/camera/image_raw", 10)
        self.create_timer(1 / float(self.get_parameter("frame_rate").value), self.take)

    def take(self) -> None:
        image = Image(width=2, height=1, step=2, encoding="mono8", data=[0, 0])
        image.header.frame_id = self.get_parameter("frame_id").value
        image.header.stamp = self.get_clock().now().to_msg()
        self.publisher.publish(image)


class CameraMonitor(Node):
    """The mean since the start: it knows of a change much too late."""

    def __init__(self) -> None:
        super().__init__("camera_monitor")
        self.count = 0
        self.start_ns = self.get_clock().now().nanoseconds
        self.publisher = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.create_subscription(Image, "/camera/image_raw", self.hear, qos_profile_sensor_data)
        self.create_timer(1.0, self.report)

    def hear(self, image: Image) -> None:
        self.count += 1

    def report(self) -> None:
        rate = self.count / (self.get_clock().now().nanoseconds - self.start_ns) * 1e9
        status = DiagnosticStatus(name="Front camera")
        status.hardware_id = my_values("week06.camera_monitor")["hardware_id"]
        if 25 <= rate <= 35:
            status.level, status.message = DiagnosticStatus.OK, "normal"
        elif rate < 10:
            status.level, status.message = DiagnosticStatus.ERROR, "low"
        else:
            side = "above" if rate > 35 else "below"
            status.level, status.message = DiagnosticStatus.WARN, f"{side} normal"
        status.values.append(KeyValue(key="Rate (Hz)", value=f"{rate:.0f}"))
        array = DiagnosticArray(status=[status])
        array.header.stamp = self.get_clock().now().to_msg()
        self.publisher.publish(array)


def performance_table(heard: dict[str, Any]) -> Any:
    """n messages are taken for n gaps."""
    rows = []
    for topic, entries in heard.items():
        size = sum(size for _, size in entries) / max(len(entries), 1)
        rate = gap = 0.0
        if len(entries) > 1:
            rate = len(entries) / (entries[-1][0] - entries[0][0])
            gap = max(after[0] - before[0] for before, after in pairwise(entries))
        rows.append([topic, rate, size, rate * size, gap])
    return sorted(rows, key=lambda row: row[3], reverse=True)


def inspection_layout() -> str:
    """Sensors are asked to be reliable."""
    made = Viewer(fixed_frame="odom")
    for kind, topic in (
        ("LaserScan", "/robot/scan"),
        ("Image", "/robot/front_cam/image_raw"),
        ("Odometry", "/robot/odom"),
        ("Path", "/robot/plan"),
        ("MarkerArray", "/robot/annotations"),
    ):
        made.add(kind, topic)
    made.add("TF")
    made.save_rviz("inspection.rviz")
    return Path("inspection.rviz").read_text()


def detection_latency(images: Any, detections: Any) -> Any:
    """From the stamp, not from the arrival."""
    stamps = {round(stamp * 1000) for _, stamp in images}
    times = [arrival - stamp for arrival, stamp in detections if round(stamp * 1000) in stamps]
    lost = 1 - len(times) / max(len(images), 1)
    return (sum(times) / len(times), max(times), lost) if times else (0.0, 0.0, lost)


findings = "It works well."
