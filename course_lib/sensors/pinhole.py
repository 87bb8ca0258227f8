"""A camera without lens errors; its optical frame: z ahead, x to the right, y down."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from sensor_msgs.msg import CameraInfo, Image
from std_msgs.msg import Header

from course_lib.sensors.checked import Floats, check_count, check_number


@dataclass(frozen=True)
class Pinhole:
    """How a camera maps points to pixels; the middle of the first pixel is (0, 0).

    Args:
        width: [px]
        height: [px]
        focal: Focal length, [px]; 277 with 320 columns see 60 degrees.
    """

    width: int = 320
    height: int = 240
    focal: float = 277.0

    def __post_init__(self) -> None:
        check_count("width [px]", self.width)
        check_count("height [px]", self.height)
        check_number("focal [px]", self.focal, above=0)

    @property
    def matrix(self) -> Floats:
        """K, shape (3, 3): optical frame to pixels."""
        middle = (self.width - 1) / 2, (self.height - 1) / 2
        return np.array([[self.focal, 0, middle[0]], [0, self.focal, middle[1]], [0, 0, 1]])

    @cached_property
    def rays(self) -> Floats:
        """Unit vectors through the middles of the pixels, row by row, shape (3, height * width)."""
        v, u = np.indices((self.height, self.width)).reshape(2, -1)
        points = np.linalg.inv(self.matrix) @ np.array([u, v, np.ones(len(u))])
        unit: Floats = points / np.linalg.norm(points, axis=0)
        return unit

    def info(self, header: Header) -> CameraInfo:
        """Describe it as sensor_msgs/CameraInfo."""
        k = self.matrix
        info = CameraInfo(header=header, width=self.width, height=self.height, distortion_model="plumb_bob")
        info.d, info.k, info.r = [0.0] * 5, k.ravel(), np.eye(3).ravel()
        info.p = np.hstack([k, np.zeros((3, 1))]).ravel()
        return info

    def message(self, header: Header, pixels: NDArray[np.generic], encoding: str) -> Image:
        """Pack pixels, shape (height, width) or (height, width, 3), as sensor_msgs/Image."""
        data = np.frombuffer(pixels.tobytes(), np.uint8)
        image = Image(header=header, encoding=encoding, height=self.height, width=self.width, data=data)
        image.step = len(data) // self.height
        return image
