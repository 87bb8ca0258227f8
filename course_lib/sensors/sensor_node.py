"""The base class of all simulated sensors: pose, rate, and reproducible noise."""

import zlib
from abc import ABC, abstractmethod
from typing import TypedDict

import numpy as np
from rclpy.node import Node
from std_msgs.msg import Header

from course_lib.arrays import Floats
from course_lib.ros.graph.graph import START_NS
from course_lib.sensors.world import Pose, World, check_number, pose_function


class SensorOptions(TypedDict, total=False):
    """Keyword arguments of every sensor."""

    name: str
    frame_id: str
    rate: float
    noise: float
    dropout: float
    seed: int


class SensorNode(Node, ABC):
    """Calls `measure` of its subclass at a rate.

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
