"""Nodes and views here follow the /clock of a robot."""

from collections.abc import Iterator

import pytest
import rclpy
from builtin_interfaces.msg import Time
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock

from course_lib import Viewer
from course_lib.ros.graph.graph import use_graph
from course_lib.ros.messages import serialize
from course_lib.ros.robot.robot_graph import RobotGraph
from course_lib.ros.time import virtual_time
from course_lib.ros.time.time_lock import time_lock
from tests.ros.zenoh.conftest import Kits
from tests.ros.zenoh.test_two_kits import BEST_EFFORT, talker, topics

CLOCK = "rosgraph_msgs/msg/Clock"


class Robot:
    """A robot whose simulation sets the time."""

    def __init__(self, graph: RobotGraph) -> None:
        self.graph = graph
        self._clock = talker(graph, "/clock", CLOCK, BEST_EFFORT)

    def set_time(self, seconds: int) -> None:
        self.graph.publish(self._clock, serialize(Clock(clock=Time(sec=seconds))))

    def is_heard(self) -> bool:
        return "/clock" in topics(self.graph, "sub")


@pytest.fixture
def robot(kits: Kits) -> Robot:
    return Robot(kits.join(send="/clock"))


@pytest.fixture
def student(kits: Kits, robot: Robot) -> Iterator[RobotGraph]:
    virtual_time.install()
    graph = kits.join()
    with use_graph(graph), time_lock.hold():
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        yield graph
        rclpy.shutdown()


def test_node_clock_and_timers_follow_the_clock_of_the_robot(
    kits: Kits, robot: Robot, student: RobotGraph
) -> None:
    node, calls = Node("follower", parameter_overrides=[Parameter("use_sim_time", value=True)]), []
    clock = node.get_clock()
    node.create_timer(10.0, lambda: calls.append(clock.now().nanoseconds // 10**9))
    kits.until(robot.is_heard, "the subscription")
    for seconds in (100, 105, 120):
        robot.set_time(seconds)

        def has_come(seconds: int = seconds) -> bool:
            rclpy.spin_once(node, timeout_sec=0)
            return clock.now().nanoseconds == seconds * 10**9

        kits.until(has_come, f"{seconds} s")
    # A poll may only find the timer ready, as in rclpy; the next one calls it.
    for _ in range(2):
        rclpy.spin_once(node, timeout_sec=0)
    assert calls == [100, 120]
    node.set_parameters([Parameter("use_sim_time", value=False)])
    kits.until(lambda: not robot.is_heard(), "the end of the subscription")
    assert clock.now().nanoseconds > 10**18


def test_viewer_with_use_sim_time_follows_the_clock_of_the_robot(
    kits: Kits, robot: Robot, student: RobotGraph
) -> None:
    viewer = Viewer()
    times = viewer.session.time
    assert times.now_ns > 10**18
    viewer.use_sim_time = True
    kits.until(robot.is_heard, "the subscription")
    robot.set_time(100)
    kits.until(lambda: times.now_ns == 100 * 10**9, "the time")
    viewer.close()
