"""Week 6, wrong answers of a second try."""

from itertools import pairwise
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Image

from course_lib import Viewer
from course_lib.grading import my_values


def robot_facts() -> dict[str, Any]:
    """Period for rate, and two facts forgotten."""
    return {"image_rate": 0.05, "image_width": "48", "trigger_service": "reset"}


class Camera(Node):
    """Follows, and rejects nothing: a rate of 0 divides by 0."""

    def __init__(self) -> None:
        super().__init__("camera")
        self.declare_parameter("frame_rate", my_values("week06.camera")["frame_rate"])
        self.declare_parameter("frame_id", "camera_link")
        self.publisher = self.create_publisher(Image, "/camera/image_raw", 10)
        self.add_on_set_parameters_callback(self.follow)
        self.timer = self.create_timer(1 / float(self.get_parameter("frame_rate").value), self.take)

    def follow(self, parameters: Any) -> SetParametersResult:
        for parameter in parameters:
            if parameter.name == "frame_rate":
                self.destroy_timer(self.timer)
                self.timer = self.create_timer(1 / max(parameter.value, 0.1), self.take)
        return SetParametersResult(successful=True)

    def take(self) -> None:
        image = Image(width=2, height=1, step=2, encoding="mono8", data=[0, 0])
        image.header.frame_id = "camera"
        image.header.stamp = self.get_clock().now().to_msg()
        self.publisher.publish(image)


class CameraMonitor(Node):
    """All that is neither OK nor ERROR is called above normal, as in the tutorial."""

    def __init__(self) -> None:
        super().__init__("camera_monitor")
        self.count = 0
        self.publisher = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.create_subscription(Image, "/camera/image_raw", self.hear, qos_profile_sensor_data)
        self.create_timer(1.0, self.report)

    def hear(self, image: Image) -> None:
        self.count += 1

    def report(self) -> None:
        rate, self.count = self.count, 0
        status = DiagnosticStatus(name="Front camera")
        status.hardware_id = my_values("week06.camera_monitor")["hardware_id"]
        if 25 < rate < 35:
            status.level, status.message = DiagnosticStatus.OK, "normal"
        elif rate < 10:
            status.level, status.message = DiagnosticStatus.ERROR, "low"
        else:
            status.level, status.message = DiagnosticStatus.WARN, "above normal"
        status.values.append(KeyValue(key="Rate (Hz)", value=str(rate)))
        array = DiagnosticArray(status=[status])
        array.header.stamp = self.get_clock().now().to_msg()
        self.publisher.publish(array)


def performance_table(heard: dict[str, Any]) -> Any:
    """In the order of the topics, not of the bandwidth."""
    rows = []
    for topic, entries in heard.items():
        times = [when for when, _ in entries]
        size = sum(size for _, size in entries) / max(len(entries), 1)
        gaps = [after - before for before, after in pairwise(times)]
        rate = len(gaps) / sum(gaps) if gaps else 0.0
        rows.append([topic, rate, size, rate * size, max(gaps, default=0.0)])
    return rows


def inspection_layout() -> str:
    """Keep is left at its default, and the frame is the viewer's."""
    made = Viewer()
    made.add("LaserScan", "/robot/scan", **{"Topic/Reliability Policy": "Best Effort"})
    made.add("Odometry", "/robot/odom")
    made.save_rviz("inspection.rviz")
    return Path("inspection.rviz").read_text()


def detection_latency(images: Any, detections: Any) -> Any:
    """The first image with the first detection, and so on."""
    times = [late - early for (early, _), (late, _) in zip(images, detections, strict=False)]
    lost = 1 - len(times) / max(len(images), 1)
    return (sum(times) / len(times), max(times), lost) if times else (0.0, 0.0, lost)


findings = ""
