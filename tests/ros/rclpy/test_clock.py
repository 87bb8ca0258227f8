import threading

import pytest
import rclpy
from rclpy.clock import Clock, ClockType, ROSClock
from rclpy.duration import Duration
from rclpy.exceptions import NotInitializedException
from rclpy.node import Node
from rclpy.time import Time

from course_lib.ros.graph.graph import START_NS, Graph


def test_all_clocks_return_robot_time(node: Node, started_graph: Graph) -> None:
    clocks = [Clock(), Clock(clock_type=ClockType.STEADY_TIME), ROSClock(), node.get_clock()]
    node.get_clock().sleep_for(Duration(seconds=2))
    assert {clock.now().nanoseconds for clock in clocks} == {START_NS + 2 * 10**9}


def test_clock_with_ros_time_is_a_ros_clock() -> None:
    clock = Clock(clock_type=ClockType.ROS_TIME)
    assert isinstance(clock, ROSClock)
    assert not clock.ros_time_is_active
    assert repr(clock) == "Clock(clock_type=ROS_TIME)"
    assert Clock().clock_type is ClockType.SYSTEM_TIME
    with pytest.raises(TypeError, match=r"^Clock type must be a ClockType enum$"):
        Clock(clock_type=2)  # type: ignore[arg-type]  # the mistake under test


def test_sleep_returns_true_unless_the_run_ends_during_it(node: Node, started_graph: Graph) -> None:
    clock = node.get_clock()
    assert clock.sleep_until(clock.now() + Duration(seconds=1))
    assert clock.sleep_until(clock.now())
    assert not clock.sleep_for(Duration(seconds=20))
    assert started_graph.now_ns == started_graph.end_ns
    assert not clock.sleep_for(Duration(seconds=1))


def test_shutdown_wakes_sleeping_threads(node: Node, started_graph: Graph) -> None:
    slept: list[bool] = []
    sleeper = threading.Thread(target=lambda: slept.append(node.get_clock().sleep_for(Duration(seconds=5))))
    sleeper.start()
    Clock().sleep_for(Duration(seconds=1))
    rclpy.shutdown()
    sleeper.join()
    assert (slept, started_graph.now_ns) == ([False], START_NS + 10**9)


def test_time_of_another_clock_type_is_rejected(started_graph: Graph) -> None:
    with pytest.raises(ValueError, match=r"^until's clock type does not match this clock's type$"):
        ROSClock().sleep_until(Time())


def test_sleep_before_init_is_rejected(graph: Graph) -> None:
    with pytest.raises(NotInitializedException):
        Clock().sleep_for(Duration(seconds=1))


def test_polling_loop_over_now_advances_time(node: Node, started_graph: Graph) -> None:
    clock, start = node.get_clock(), node.get_clock().now()
    while clock.now() - start < Duration(seconds=1):
        pass
    assert started_graph.now_ns >= START_NS + 10**9
