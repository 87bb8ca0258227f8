"""Simulated sensors: cameras with a pinhole model; laser scanners, ultrasound and infrared.

Their base class has the pose, the rate and reproducible noise.
"""

import io
import zlib
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, TypedDict, Unpack

import numpy as np
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, LaserScan, PointCloud2, PointField, Range
from std_msgs.msg import Header

from course_lib.arrays import AnyArray, Bytes, Floats
from course_lib.errors import CourseError
from course_lib.ros.graph.graph import START_NS
from course_lib.sensors.world import Pose, World, check_count, check_limits, check_number, pose_function


class SensorOptions(TypedDict, total=False):
    """Keyword arguments of every sensor."""

    name: str
    frame_id: str
    rate: float
    noise: float
    dropout: float
    seed: int


class SensorNode(Node, ABC):
    """Base class of sensors, which calls `measure` of the subclass at a fixed rate.

    Args:
        world: The world to measure.
        pose: transform_sensor_to_world, shape (4, 4), [m], or a function of robot time [s] that
            returns it.
        name: The node's name.
        frame_id: The sensor's frame in the messages.
        rate: Rate of measurements, [Hz].
        noise: Standard deviation: of distances in [m], of colors in steps of 1/255.
        dropout: Fraction of the values that are lost, 0 to 1.
        seed: The same seed gives the same data.
    """

    def __init__(
        self,
        world: World,
        pose: Pose,
        *,
        name: str,
        frame_id: str,
        rate: float = 10.0,
        noise: float = 0.0,
        dropout: float = 0.0,
        seed: int = 0,
    ) -> None:
        self.world, self.frame_id = world, frame_id
        self.seed = int(check_number("seed", seed, low=0))
        self.transform_at = pose_function(f"pose of {name}", pose)
        self.noise = check_number("noise", noise, low=0)
        self.dropout = check_number("dropout", dropout, low=0, high=1)
        self.period = 1 / check_number("rate [Hz]", rate, above=0)
        super().__init__(name)
        self.timer = self.create_timer(self.period, self._tick)

    @abstractmethod
    def measure(self, header: Header, seconds: float, chance: np.random.Generator) -> None:
        """Measure and publish. Must be overridden.

        Args:
            header: The header of the message, with stamp and frame.
            seconds: Robot time since the start of the run, [s].
            chance: The random generator for noise, which depends on seed, stamp and name.
        """

    def add_noise(
        self,
        distance: Floats,
        limits: tuple[float, float],
        chance: np.random.Generator,
    ) -> Floats:
        """Return distances with noise.

        As in REP 117, inf means too far, -inf too near, and NaN a lost measurement.

        Args:
            distance: The measured distances, shape (N,), [m].
            limits: Minimum and maximum distance, [m].
            chance: The random generator of `measure`.
        """
        noisy = distance + self.noise * chance.standard_normal(distance.shape)
        noisy[noisy > limits[1]] = np.inf
        noisy[noisy < limits[0]] = -np.inf
        noisy[chance.random(distance.shape) < self.dropout] = np.nan
        return noisy

    def _tick(self) -> None:
        now = self.get_clock().now()
        header = Header(stamp=now.to_msg(), frame_id=self.frame_id)
        # The seed contains the stamp instead of the number of calls, so that a sensor that starts
        # later has the same noise.
        chance = np.random.default_rng((self.seed, now.nanoseconds, zlib.crc32(self.get_name().encode())))
        self.measure(header, (now.nanoseconds - START_NS) * 1e-9, chance)


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
    """Publishes `<prefix>/image_raw` in color, `…/image_raw/compressed` and `<prefix>/camera_info`.

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
            raise CourseError(f"compressed is {compressed!r}; expected 'png', 'jpeg' or None.")
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
    """Return the brightness of surfaces, 0 to 1, shape (N,), by their angle to the camera.

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


_POINT = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("rgb", "<u4")])


def beams_at(azimuth: Floats, elevation: Floats) -> Floats:
    """Return unit vectors, shape (3, N), at an azimuth about z from x and an elevation [rad]."""
    level = np.cos(elevation)
    return np.array([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)])


class LaserScanNode(SensorNode):
    """Publishes sensor_msgs/LaserScan.

    Args:
        world: The world to measure.
        pose: transform_laser_to_world, shape (4, 4), [m], or a function of robot time [s] that
            returns it.
        topic: The topic of the scans.
        beams: Number of beams, spaced evenly from `angle_min` to `angle_max`, counter-clockwise.
        angle_min: Angle of the first beam from x about z, [rad].
        angle_max: Angle of the last beam, [rad].
        range_min: Shorter distances are -inf, [m].
        range_max: Longer distances are inf, [m].
        common: Name, frame_id, rate, noise, dropout and seed, as for `SensorNode`.
    """

    def __init__(
        self,
        world: World,
        pose: Pose,
        *,
        topic: str = "scan",
        beams: int = 720,
        angle_min: float = -np.pi,
        angle_max: float = np.pi,
        range_min: float = 0.1,
        range_max: float = 30.0,
        **common: Unpack[SensorOptions],
    ) -> None:
        self.limits = check_limits("range", "m", range_min, range_max)
        self.angles = np.linspace(
            *check_limits("angle", "rad", angle_min, angle_max), check_count("beams", beams)
        )
        self.rays = beams_at(self.angles, np.zeros(beams))
        super().__init__(world, pose, **(SensorOptions(name="lidar", frame_id="laser") | common))
        self.publisher = self.create_publisher(LaserScan, topic, qos_profile_sensor_data)

    def measure(self, header: Header, seconds: float, chance: np.random.Generator) -> None:
        """Publish a scan. All its beams are measured at the same time."""
        hits = self.world.cast(self.transform_at(seconds), self.rays, seconds)
        ranges = self.add_noise(hits.distance, self.limits, chance)
        first, last = float(self.angles[0]), float(self.angles[-1])
        scan = LaserScan(header=header, angle_min=first, angle_max=last, ranges=ranges, scan_time=self.period)
        scan.angle_increment = (last - first) / max(len(ranges) - 1, 1)
        scan.range_min, scan.range_max = self.limits
        self.publisher.publish(scan)


class PointCloudNode(SensorNode):
    """Publishes sensor_msgs/PointCloud2 with the fields x, y, z [m] and rgb.

    Args:
        world: The world to measure.
        pose: transform_laser_to_world, shape (4, 4), [m], or a function of robot time [s] that
            returns it.
        topic: The topic of the clouds.
        columns: Number of rays per ring, spaced evenly around z.
        rings: Number of rings, spaced evenly from -`opening` to `opening`.
        opening: Elevation of the highest ring, [rad].
        range_min: Points at shorter distances are omitted, [m].
        range_max: Points at longer distances are omitted, [m].
        common: Name, frame_id, rate, noise, dropout and seed, as for `SensorNode`.
    """

    def __init__(
        self,
        world: World,
        pose: Pose,
        *,
        topic: str = "points",
        columns: int = 360,
        rings: int = 16,
        opening: float = np.pi / 12,
        range_min: float = 0.3,
        range_max: float = 30.0,
        **common: Unpack[SensorOptions],
    ) -> None:
        self.limits = check_limits("range", "m", range_min, range_max)
        opening = check_number("opening [rad]", opening, low=0, high=np.pi / 2)
        around = np.linspace(-np.pi, np.pi, check_count("columns", columns), endpoint=False)
        up = np.linspace(-opening, opening, check_count("rings", rings))
        self.rays = beams_at(np.tile(around, rings), np.repeat(up, columns))
        super().__init__(world, pose, **(SensorOptions(name="lidar_3d", frame_id="laser") | common))
        self.publisher = self.create_publisher(PointCloud2, topic, qos_profile_sensor_data)

    def measure(self, header: Header, seconds: float, chance: np.random.Generator) -> None:
        """Publish a cloud with the points of all rays that hit something."""
        hits = self.world.cast(self.transform_at(seconds), self.rays, seconds)
        distance = self.add_noise(hits.distance, self.limits, chance)
        met = np.isfinite(distance)
        points = np.empty(int(met.sum()), _POINT)
        points["x"], points["y"], points["z"] = self.rays[:, met] * distance[met]
        red, green, blue = np.rint(self.world.colors[hits.thing[met]].T * 255).astype(np.uint32)
        points["rgb"] = red << 16 | green << 8 | blue
        cloud = PointCloud2(header=header, height=1, width=len(points), is_dense=True)
        cloud.fields = [
            PointField(name=name, offset=4 * number, datatype=PointField.FLOAT32, count=1)
            for number, name in enumerate(_POINT.names or ())
        ]
        cloud.point_step, cloud.row_step = _POINT.itemsize, points.nbytes
        cloud.data = points.view(np.uint8)
        self.publisher.publish(cloud)


def cone_rays(field_of_view: float, count: int) -> Floats:
    """Return unit vectors, shape (3, count), spread evenly over a cone [rad] around x.

    The first is its axis.
    """
    # The golden angle, as in the pattern of a sunflower's seeds.
    turn = np.arange(count) * np.pi * (3 - np.sqrt(5))
    forward = 1 - (1 - np.cos(field_of_view / 2)) * np.arange(count) / max(count - 1, 1)
    sideways = np.sqrt(1 - forward**2)
    return np.array([forward, sideways * np.cos(turn), sideways * np.sin(turn)])


class RangeNode(SensorNode):
    """Publishes sensor_msgs/Range: the distance of the nearest object in a cone around x.

    Args:
        world: The world to measure.
        pose: transform_range_to_world, shape (4, 4), [m], or a function of robot time [s] that
            returns it.
        topic: The topic of the ranges.
        field_of_view: The full angle of the cone, [rad].
        rays: Number of rays, spread evenly over the cone.
        range_min: Shorter distances are -inf, [m].
        range_max: Longer distances are inf, [m].
        radiation_type: Range.ULTRASOUND or Range.INFRARED.
        common: Name, frame_id, rate, noise, dropout and seed, as for `SensorNode`.
    """

    def __init__(
        self,
        world: World,
        pose: Pose,
        *,
        topic: str = "range",
        field_of_view: float = np.pi / 9,
        rays: int = 100,
        range_min: float = 0.02,
        range_max: float = 4.0,
        radiation_type: int = Range.ULTRASOUND,
        **common: Unpack[SensorOptions],
    ) -> None:
        self.limits = check_limits("range", "m", range_min, range_max)
        self.field_of_view = check_number("field_of_view [rad]", field_of_view, above=0, high=np.pi)
        self.rays = cone_rays(self.field_of_view, check_count("rays", rays))
        self.radiation_type = radiation_type
        super().__init__(world, pose, **(SensorOptions(name="range_finder", frame_id="range") | common))
        self.publisher = self.create_publisher(Range, topic, qos_profile_sensor_data)

    def measure(self, header: Header, seconds: float, chance: np.random.Generator) -> None:
        """Publish the shortest distance, with noise.

        Noise is added once, because the minimum of many noisy distances would be too short.
        """
        hits = self.world.cast(self.transform_at(seconds), self.rays, seconds)
        nearest = self.add_noise(hits.distance.min(keepdims=True), self.limits, chance)
        message = Range(header=header, radiation_type=self.radiation_type, field_of_view=self.field_of_view)
        message.min_range, message.max_range = self.limits
        message.range, message.variance = float(nearest[0]), self.noise**2
        self.publisher.publish(message)
