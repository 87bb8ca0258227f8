"""Range sensors: laser scanners in 2D and 3D, ultrasound and infrared."""

from typing import Unpack

import numpy as np
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan, PointCloud2, PointField, Range
from std_msgs.msg import Header

from course_lib.arrays import Floats
from course_lib.sensors.sensor_node import SensorNode, SensorOptions
from course_lib.sensors.world import Pose, World, check_count, check_limits, check_number

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
    """Publishes sensor_msgs/Range: the distance of the nearest thing in a cone around x.

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
