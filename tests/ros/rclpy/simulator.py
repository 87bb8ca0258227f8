"""A source of /clock with a configurable speed, and helpers for tests of `use_sim_time`."""

from collections.abc import Callable

from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.time import Time
from rosgraph_msgs.msg import Clock as ClockMessage

SIM = Parameter("use_sim_time", value=True)
ROBOT = Parameter("use_sim_time", value=False)


class Simulator(Node):
    """Publishes /clock every 0.1 s of robot time, from 100 s on, `speed` times as fast."""

    def __init__(self, speed: float = 1.0, delay: float = 0.0) -> None:
        super().__init__("simulator")
        self.now = Time(seconds=100, clock_type=ClockType.ROS_TIME)
        self._step = Duration(seconds=0.1 * speed)
        self._publisher = self.create_publisher(ClockMessage, "/clock", 10)
        self._waits = round(delay / 0.1)
        self.create_timer(0.1, self.step)

    def step(self) -> None:
        self._waits -= 1
        if self._waits < 0:
            self.now += self._step
            self._publisher.publish(ClockMessage(clock=self.now.to_msg()))


def seconds(clock: Clock) -> float:
    return round(clock.now().nanoseconds * 1e-9, 6)


def spin(until: Callable[[], bool] | float, *nodes: Node) -> None:
    executor = MultiThreadedExecutor()
    for node in nodes:
        executor.add_node(node)
    if callable(until):
        while not until():
            executor.spin_once()
    else:
        end_ns = nodes[0].handle.graph.now_ns + round(until * 1e9)
        executor._course_spin_until(end_ns)
    for node in nodes:
        executor.remove_node(node)


def say_time(node: Node, now: float) -> None:
    """Publish one message on /clock and let it arrive."""
    publisher = node.create_publisher(ClockMessage, "/clock", 10)
    publisher.publish(ClockMessage(clock=Time(seconds=now).to_msg()))
    spin(0.01, node)
    node.destroy_publisher(publisher)
