"""Ultrasound or infrared: how far away the nearest thing in a cone is; x ahead."""

from typing import Unpack

import numpy as np
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Range
from std_msgs.msg import Header

from course_lib.sensors.checked import Floats, Pose, check_count, check_limits, check_number
from course_lib.sensors.sensor_node import Common, SensorNode
from course_lib.sensors.world import World


def cone_rays(field_of_view: float, count: int) -> Floats:
    """Spread unit vectors, shape (3, count), evenly over a cone [rad] around x; the first is its axis."""
    turn = np.arange(count) * np.pi * (3 - np.sqrt(5))  # the golden angle: a sunflower's pattern
    ahead = 1 - (1 - np.cos(field_of_view / 2)) * np.arange(count) / max(count - 1, 1)
    aside = np.sqrt(1 - ahead**2)
    return np.array([ahead, aside * np.cos(turn), aside * np.sin(turn)])


class RangeNode(SensorNode):
    """Publishes sensor_msgs/Range: the nearest of `rays` within `field_of_view` [rad], the whole angle."""

    def __init__(
        self,
        world: World,
        pose: Pose,
        *,
        topic: str = "range",
        field_of_view: float = np.pi / 9,
        rays: int = 100,
        range_min: float = 0.02,  # [m]
        range_max: float = 4.0,  # [m]
        radiation_type: int = Range.ULTRASOUND,
        **common: Unpack[Common],
    ) -> None:
        self.limits = check_limits("range", "m", range_min, range_max)
        self.field_of_view = check_number("field_of_view [rad]", field_of_view, above=0, high=np.pi)
        self.rays = cone_rays(self.field_of_view, check_count("rays", rays))
        self.radiation_type = radiation_type
        super().__init__(world, pose, **(Common(name="range_finder", frame_id="range") | common))
        self.publisher = self.create_publisher(Range, topic, qos_profile_sensor_data)

    def measure(self, header: Header, seconds: float, chance: np.random.Generator) -> None:
        """Publish one distance with one noise: the nearest of many noisy ones would be too short."""
        hits = self.world.cast(self.transform_at(seconds), self.rays, seconds)
        nearest = self.disturbed(hits.distance.min(keepdims=True), self.limits, chance)
        message = Range(header=header, radiation_type=self.radiation_type, field_of_view=self.field_of_view)
        message.min_range, message.max_range = self.limits
        message.range, message.variance = float(nearest[0]), self.noise**2
        self.publisher.publish(message)
