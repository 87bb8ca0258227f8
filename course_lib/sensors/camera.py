"""Cameras: the pinhole model, and a node that publishes images of the world."""

import io
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, Unpack

import numpy as np
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_msgs.msg import Header

from course_lib.arrays import AnyArray, Bytes, Floats
from course_lib.errors import CourseError
from course_lib.sensors.sensor_node import SensorNode, SensorOptions
from course_lib.sensors.world import Pose, World, check_count, check_number

# Fraction of ambient light.
_AMBIENT = 0.4
# Rows shaded per step. Shading the whole picture takes twice the time and four times the memory.
_ROWS = 32


@dataclass(frozen=True)
class Pinhole:
    """A camera's projection of points to pixels. The center of the first pixel is (0, 0).

    Args:
        width: [px]
        height: [px]
        focal: Focal length, [px]; 277 with 320 columns is a field of view of 60 degrees.
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
        """The camera matrix K, shape (3, 3), from the optical frame to pixels."""
        middle = (self.width - 1) / 2, (self.height - 1) / 2
        return np.array([[self.focal, 0, middle[0]], [0, self.focal, middle[1]], [0, 0, 1]])

    @cached_property
    def rays(self) -> Floats:
        """Unit vectors through the centers of the pixels, row by row, shape (3, height * width)."""
        v, u = np.indices((self.height, self.width)).reshape(2, -1)
        points = np.linalg.inv(self.matrix) @ np.array([u, v, np.ones(len(u))])
        unit: Floats = points / np.linalg.norm(points, axis=0)
        return unit

    def info(self, header: Header) -> CameraInfo:
        """Return the model as sensor_msgs/CameraInfo with a header."""
        k = self.matrix
        info = CameraInfo(header=header, width=self.width, height=self.height, distortion_model="plumb_bob")
        info.d, info.k, info.r = [0.0] * 5, k.ravel(), np.eye(3).ravel()
        info.p = np.hstack([k, np.zeros((3, 1))]).ravel()
        return info

    def message(self, header: Header, pixels: AnyArray, encoding: str) -> Image:
        """Return pixels, shape (height, width) or (height, width, 3), as sensor_msgs/Image."""
        data = np.frombuffer(pixels.tobytes(), np.uint8)
        image = Image(header=header, encoding=encoding, height=self.height, width=self.width, data=data)
        image.step = len(data) // self.height
        return image


class CameraNode(SensorNode):
    """Publishes `<prefix>/image_raw` in color, `<prefix>/image_raw/compressed` and `<prefix>/camera_info`.

    Args:
        world: The world to measure.
        pose: transform_optical_to_world, shape (4, 4), [m], or a function of robot time [s] that
            returns it.
        prefix: Prefix of the topics.
        pinhole: The camera's model; by default 320 x 240 pixels with a field of view of 60 degrees.
        compressed: "png", "jpeg", or None for no compressed pictures.
        common: Name, frame_id, rate, noise, dropout and seed, as for `SensorNode`.
    """

    def __init__(
        self,
        world: World,
        pose: Pose,
        *,
        prefix: str = "camera",
        pinhole: Pinhole | None = None,
        compressed: Literal["png", "jpeg"] | None = "png",
        **common: Unpack[SensorOptions],
    ) -> None:
        if compressed not in ("png", "jpeg", None):
            raise CourseError(f"compressed is {compressed!r}; give 'png', 'jpeg' or None.")
        self.pinhole, self.compressed = pinhole or Pinhole(), compressed
        super().__init__(
            world, pose, **(SensorOptions(name="camera", frame_id="camera_optical_frame") | common)
        )
        topic, qos = f"{prefix}/image_raw", qos_profile_sensor_data
        self.images = self.create_publisher(Image, topic, qos)
        self.infos = self.create_publisher(CameraInfo, f"{prefix}/camera_info", qos)
        self.packed = (
            self.create_publisher(CompressedImage, f"{topic}/compressed", qos) if compressed else None
        )

    def measure(self, header: Header, seconds: float, chance: np.random.Generator) -> None:
        """Publish a picture with its CameraInfo."""
        pixels = self.picture(seconds, chance)
        self.infos.publish(self.pinhole.info(header))
        self.images.publish(self.pinhole.message(header, pixels, "rgb8"))
        if self.packed and self.compressed:
            text, data = f"rgb8; {self.compressed} compressed bgr8", compress(pixels, self.compressed)
            self.packed.publish(
                CompressedImage(header=header, format=text, data=np.frombuffer(data, np.uint8))
            )

    def picture(self, seconds: float, chance: np.random.Generator) -> Bytes:
        """Render the world at a robot time [s], lit from the camera; shape (height, width, 3)."""
        camera = self.pinhole
        hits = self.world.cast(self.transform_at(seconds), camera.rays, seconds)
        light = shade(camera.rays, hits.distance, camera.width)
        colors = 255 * self.world.colors[hits.thing] * light[:, None]
        colors += self.noise * chance.standard_normal(colors.shape)
        colors[chance.random(len(colors)) < self.dropout] = 0
        return np.clip(np.rint(colors), 0, 255).astype(np.uint8).reshape(camera.height, camera.width, 3)


def shade(rays: Floats, distance: Floats, width: int) -> Floats:
    """Return the brightness of surfaces by their angle to the camera, shape (N,), 0 to 1; edges are dark.

    The surface at a pixel is spanned by the points of its neighbors, so shapes need no normals.
    """
    light, block = np.empty(len(distance)), _ROWS * width
    for start in range(0, len(distance), block):
        # Including the row below, which the differences need.
        rows = slice(start, start + block + width)
        light[start : start + block] = _shade(rays[:, rows], distance[rows], width)[:block]
    return light


def _shade(rays: Floats, distance: Floats, width: int) -> Floats:
    """Return the brightness of some rows of a picture."""
    points = (rays * np.where(np.isfinite(distance), distance, 1e3)).reshape(3, -1, width)
    right, down = (np.diff(points, axis=axis, append=points.take([-1], axis)) for axis in (2, 1))
    normals = np.cross(right, down, axis=0).reshape(3, -1)
    length = np.linalg.norm(normals, axis=0)
    facing = np.abs((normals * rays).sum(axis=0)) / np.where(length > 0, length, 1)
    # The last row and column have no neighbors, so they are not shaded.
    light = np.where(length > 0, _AMBIENT + (1 - _AMBIENT) * facing, 1.0)
    return np.where(np.isfinite(distance), light, 1.0)


def compress(pixels: Bytes, kind: Literal["png", "jpeg"]) -> bytes:
    """Compress a picture, shape (height, width, 3), as a PNG or JPEG file."""
    # Imported on first use, because most sensors need no Pillow.
    from PIL import Image as Pictures

    file = io.BytesIO()
    Pictures.fromarray(pixels).save(file, kind)
    return file.getvalue()
