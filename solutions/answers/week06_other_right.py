"""Week 6, another right solution."""

from collections import deque
from itertools import pairwise
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Image

from course_lib.grading import my_values


def robot_facts() -> dict[str, Any]:
    """As they are measured, and written by hand: those of robot 11, the first option."""
    return {
        "image_rate": np.float64(14.0),
        "image_width": 80,
        "scan_reliability": "RELIABLE",
        "threshold": 0.4,
        "trigger_service": "/robot/release_brakes",
        "scan_rate": 10.0,
    }


class Camera(Node):
    """Limits by a descriptor; the timer is made anew after each change."""

    def __init__(self) -> None:
        super().__init__("camera")
        limits = ParameterDescriptor(floating_point_range=[FloatingPointRange(from_value=1.0, to_value=60.0)])
        self.declare_parameters(
            "",
            [
                ("frame_rate", my_values("week06.camera")["frame_rate"], limits),
                ("frame_id", "camera_link"),
            ],
        )
        self.images = self.create_publisher(Image, "camera/image_raw", 10)
        self.add_post_set_parameters_callback(self.restart)
        self.timer: Any = None
        self.restart([])

    def restart(self, parameters: Any) -> None:
        if self.timer is not None:
            self.timer.cancel()
        self.timer = self.create_timer(1 / float(self.get_parameter("frame_rate").value), self.take)

    def take(self) -> None:
        image = Image(width=1, height=1, encoding="rgb8", step=3, data=[1, 2, 3])
        image.header.frame_id = self.get_parameter("frame_id").value
        image.header.stamp = self.get_clock().now().to_msg()
        self.images.publish(image)


class CameraMonitor(Node):
    """Keeps the times of the images of the last second."""

    BANDS = (
        (10, DiagnosticStatus.ERROR, "Low frame rate"),
        (25, DiagnosticStatus.WARN, "Frame rate below normal"),
        (36, DiagnosticStatus.OK, "Operating normally"),
        (float("inf"), DiagnosticStatus.WARN, "Frame rate above normal"),
    )

    def __init__(self) -> None:
        super().__init__("monitor")
        self.times: deque[int] = deque()
        self.create_subscription(
            Image, "/camera/image_raw", lambda _: self.times.append(self.now()), qos_profile_sensor_data
        )
        self.diagnostics = self.create_publisher(DiagnosticArray, "/diagnostics", 10)
        self.create_timer(1.0, self.report)

    def now(self) -> int:
        return self.get_clock().now().nanoseconds

    def report(self) -> None:
        while self.times and self.times[0] <= self.now() - 10**9:
            self.times.popleft()
        count = len(self.times)
        level, message = next((level, text) for limit, level, text in self.BANDS if count < limit)
        status = DiagnosticStatus(name="Front camera", level=level, message=f"{message}: {count} Hz")
        status.hardware_id = my_values("week06.camera_monitor")["hardware_id"]
        status.values.append(KeyValue(key="Rate (Hz)", value=f"{count}"))
        array = DiagnosticArray()
        array.header.stamp = self.get_clock().now().to_msg()
        array.status.append(status)
        self.diagnostics.publish(array)


def performance_table(heard: dict[str, Any]) -> Any:
    """With numpy, and tuples for rows."""

    def row(topic: str, entries: Any) -> tuple[Any, ...]:
        size = float(np.mean([size for _, size in entries])) if entries else 0
        if len(entries) < 2:
            return topic, 0, size, 0, 0
        times = [when for when, _ in entries]
        gaps = [after - before for before, after in pairwise(times)]
        return topic, 1 / np.mean(gaps), size, size / np.mean(gaps), np.max(gaps)

    return sorted((row(*item) for item in heard.items()), key=lambda made: -made[3])


def inspection_layout() -> str:
    """The file, as somebody who knows YAML writes it."""
    keep = my_values("week06.inspection_layout")["keep"]
    rows = {
        "LaserScan": "/robot/scan, Reliability Policy: Best Effort",
        "Image": "/robot/front_cam/image_raw, Reliability Policy: Best Effort",
        "Path": "/robot/plan",
        "MarkerArray": "/robot/annotations",
    }
    lines = [
        f"    - {{Class: rviz_default_plugins/{name}, Name: {name}, Topic: {{Value: {topic}}}}}"
        for name, topic in rows.items()
    ]
    text = "\n".join(lines)
    return f"""
Visualization Manager:
  Displays:
    - {{Class: rviz_default_plugins/TF, Name: Frames}}
    - {{Class: rviz_default_plugins/Odometry, Name: Way, Keep: {keep}, Topic: {{Value: /robot/odom}}}}
{text}
  Global Options: {{Fixed Frame: odom}}
"""


def detection_latency(images: Any, detections: Any) -> Any:
    """Every pair is compared."""
    pairs = [
        (number, late - early)
        for number, (early, stamp) in enumerate(images)
        for late, same in detections
        if abs(stamp - same) < 1e-3
    ]
    times = [seconds for _, seconds in pairs] or [0.0]
    found = len({number for number, _ in pairs})
    return np.mean(times), max(times), (len(images) - found) / max(len(images), 1)


findings = "word " * 150
