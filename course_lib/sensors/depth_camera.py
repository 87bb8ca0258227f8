"""A depth camera."""

from typing import Literal, Unpack

import numpy as np
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

from course_lib.errors import CourseError
from course_lib.sensors.checked import Pose, check_limits
from course_lib.sensors.pinhole import Pinhole
from course_lib.sensors.sensor_node import Common, SensorNode
from course_lib.sensors.world import World


class DepthCameraNode(SensorNode):
    """Publishes depth along z: `<prefix>/image_raw` and `<prefix>/camera_info`.

    Args:
        encoding: "32FC1" in [m] or "16UC1" in [mm]; there 0 stands for what is not known (REP 118).
    """

    def __init__(
        self,
        world: World,
        pose: Pose,
        *,
        prefix: str = "depth",
        pinhole: Pinhole | None = None,
        encoding: Literal["32FC1", "16UC1"] = "32FC1",
        range_min: float = 0.2,  # [m]
        range_max: float = 10.0,  # [m]
        **common: Unpack[Common],
    ) -> None:
        if encoding not in ("32FC1", "16UC1"):
            raise CourseError(f"encoding is {encoding!r}; give '32FC1' (metres) or '16UC1' (millimetres).")
        self.limits = check_limits("range", "m", range_min, range_max)
        self.pinhole, self.encoding = pinhole or Pinhole(), encoding
        super().__init__(world, pose, **(Common(name="depth", frame_id="camera_optical_frame") | common))
        self.images = self.create_publisher(Image, f"{prefix}/image_raw", qos_profile_sensor_data)
        self.infos = self.create_publisher(CameraInfo, f"{prefix}/camera_info", qos_profile_sensor_data)

    def measure(self, header: Header, seconds: float, chance: np.random.Generator) -> None:
        """Publish one depth image and what describes it."""
        camera = self.pinhole
        hits = self.world.cast(self.transform_at(seconds), camera.rays, seconds)
        depth = self.disturbed(hits.distance * camera.rays[2], self.limits, chance)
        if self.encoding == "16UC1":
            depth = np.rint(np.where((depth > 0) & (depth < 65.5), depth * 1000, 0))  # [mm], 16 bits
        pixels = depth.astype("<f4" if self.encoding == "32FC1" else "<u2")
        self.infos.publish(camera.info(header))
        self.images.publish(camera.message(header, pixels.reshape(camera.height, -1), self.encoding))
