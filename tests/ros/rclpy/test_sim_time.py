"""Nodes with `use_sim_time` and a source of /clock with a configurable speed."""

import threading
from typing import Any

import pytest
import rclpy
from builtin_interfaces.msg import Time as TimeMessage
from rcl_interfaces.srv import SetParameters
from rclpy.clock import Clock, ClockType, ROSClock
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.time import Time
from rclpy.time_source import TimeSource
from std_msgs.msg import String

from course_lib.recording import record
from course_lib.ros.graph.graph import Graph, use_graph
from tests.ros.rclpy.simulator import ROBOT, SIM, Simulator, say_time, seconds, spin


def test_sim_time_is_zero_until_the_first_clock_message_and_then_follows_it(follower: Node) -> None:
    clock, simulator = follower.get_clock(), Simulator(speed=2.0, delay=1.0)
    assert isinstance(clock, ROSClock)
    assert clock.ros_time_is_active
    spin(1.0, follower, simulator)
    assert clock.now() == Time(clock_type=ClockType.ROS_TIME)
    spin(1.05, follower, simulator)
    assert seconds(clock) == 102.0


def test_clock_topic_is_ignored_without_the_parameter(node: Node) -> None:
    before = node.get_clock().now()
    spin(1.0, node, Simulator(speed=5.0))
    assert node.get_clock().now() - before == Duration(seconds=1)
    assert [s.topic_name for s in node.subscriptions] == []


def test_use_sim_time_can_be_set_on_the_command_line(graph: Graph) -> None:
    rclpy.init(args=["--ros-args", "-p", "use_sim_time:=true"])
    clock = Node("follower").get_clock()
    assert isinstance(clock, ROSClock)
    assert clock.ros_time_is_active
    assert seconds(clock) == 0


def test_timer_waits_for_the_clock_topic_and_then_keeps_its_period_in_sim_time(follower: Node) -> None:
    calls: list[float] = []
    follower.create_timer(1.0, lambda: calls.append(seconds(follower.get_clock())))
    simulator = Simulator(speed=2.0, delay=5.0)
    spin(4.9, follower, simulator)
    assert calls == []
    spin(3.2, follower, simulator)
    assert calls == [100.2, 101.0, 102.0, 103.0, 104.0, 105.0, 106.0]


def test_timers_with_other_clocks_use_robot_time(follower: Node) -> None:
    called = dict.fromkeys(ClockType, 0)

    def count(kind: ClockType) -> None:
        called[kind] += 1

    for kind in (ClockType.STEADY_TIME, ClockType.SYSTEM_TIME, ClockType.ROS_TIME):
        follower.create_timer(1.0, lambda kind=kind: count(kind), clock=Clock(clock_type=kind))  # type: ignore[misc]
    follower.create_timer(1.0, lambda: count(ClockType.UNINITIALIZED))
    spin(3.0, follower)
    assert list(called.values()) == [0, 3, 3, 3]


def test_forward_jump_calls_a_timer_once_and_keeps_its_phase(follower: Node) -> None:
    calls: list[float] = []
    say_time(follower, 10.0)
    timer = follower.create_timer(1.0, lambda: calls.append(seconds(follower.get_clock())))
    for now in (10.9, 15.5, 15.9, 16.0):
        say_time(follower, now)
    assert calls == [15.5, 16.0]
    assert timer.time_until_next_call() == 10**9


def test_timer_waits_one_period_after_a_backward_jump(follower: Node) -> None:
    calls: list[float] = []
    say_time(follower, 50.0)
    timer = follower.create_timer(1.0, lambda: calls.append(seconds(follower.get_clock())))
    for now in (51.0, 20.0, 20.9, 21.0):
        say_time(follower, now)
    assert calls == [51.0, 21.0]
    assert timer.time_since_last_call() == 0


def test_due_timer_is_not_called_after_a_backward_time_jump(follower: Node) -> None:
    calls: list[float] = []
    clock = follower.get_clock()
    assert isinstance(clock, ROSClock)
    clock.set_ros_time_override(Time(seconds=10, clock_type=ClockType.ROS_TIME))
    timer = follower.create_timer(1.0, lambda: calls.append(seconds(clock)))
    clock.set_ros_time_override(Time(seconds=11, clock_type=ClockType.ROS_TIME))
    assert timer.is_ready()
    clock.set_ros_time_override(Time(seconds=5, clock_type=ClockType.ROS_TIME))
    assert not timer.is_ready()
    spin(1.0, follower)
    assert calls == []


def test_canceled_timer_ignores_the_clock_until_its_reset(follower: Node) -> None:
    calls: list[float] = []
    say_time(follower, 10.0)
    timer = follower.create_timer(1.0, lambda: calls.append(seconds(follower.get_clock())))
    timer.cancel()
    say_time(follower, 12.0)
    timer.reset()
    say_time(follower, 12.5)
    say_time(follower, 13.0)
    assert calls == [13.0]
    follower.destroy_timer(timer)
    say_time(follower, 20.0)
    assert calls == [13.0]


def test_timer_with_period_zero_is_always_ready(follower: Node) -> None:
    calls: list[float] = []
    follower.create_timer(0.0, lambda: calls.append(0.0))
    spin(0.1, follower)
    assert len(calls) == 100


def test_use_sim_time_can_be_switched_on_and_off_at_run_time(node: Node) -> None:
    calls: list[float] = []
    clock, robot_time = node.get_clock(), Clock()
    node.create_timer(1.0, lambda: calls.append(seconds(clock)))
    spin(2.0, node)
    assert node.set_parameters([SIM])[0].successful
    spin(5.0, node)
    assert (seconds(clock), len(calls)) == (0.0, 2)
    for now in (5.0, 6.0, 6.5):
        say_time(node, now)
    assert calls[2:] == [6.0]
    node.set_parameters([ROBOT])
    assert [s.topic_name for s in node.subscriptions] == []
    assert seconds(clock) == seconds(robot_time)
    spin(1.0, node)
    assert len(calls) == 4


def test_parameter_service_sets_use_sim_time(node: Node) -> None:
    client = node.create_client(SetParameters, "/talker/set_parameters")
    future = client.call_async(SetParameters.Request(parameters=[SIM.to_parameter_msg()]))
    spin(future.done, node)
    assert node.get_clock().now().nanoseconds == 0


def test_non_boolean_value_is_rejected(started_graph: Graph, capfd: pytest.CaptureFixture[str]) -> None:
    node = Node("follower", automatically_declare_parameters_from_overrides=True, parameter_overrides=[SIM])
    source = TimeSource(node=node)
    result = source._on_parameter_event([Parameter("use_sim_time", value=1)])
    assert (result.successful, result.reason) == (
        False,
        "use_sim_time parameter set to something besides a bool",
    )
    assert "[follower]: use_sim_time parameter set to something besides a bool" in capfd.readouterr().err


def test_node_without_clock_messages_gets_a_hint(follower: Node, capsys: pytest.CaptureFixture[str]) -> None:
    Node("early", parameter_overrides=[SIM]).set_parameters([ROBOT])
    Node("gone", parameter_overrides=[SIM]).destroy_node()
    spin(3.0, follower)
    assert capsys.readouterr().out == (
        "hint: /follower has use_sim_time, and nobody publishes /clock: its time stands at 0 and its timers "
        "wait. Start a simulation or `ros2 bag play --clock`, or set use_sim_time to false.\n"
    )


def test_paused_simulation_gets_no_hint(follower: Node, capsys: pytest.CaptureFixture[str]) -> None:
    spin(3.0, follower, Simulator(delay=9.0))
    assert capsys.readouterr().out == ""


def test_rate_follows_the_sim_clock(follower: Node) -> None:
    simulator = Simulator(speed=2.0)
    thread = threading.Thread(target=spin, args=(9.0, follower, simulator), daemon=True)
    thread.start()
    rate, times = follower.create_rate(1.0), []
    for _ in range(3):
        rate.sleep()
        times.append(seconds(follower.get_clock()))
    assert times == [100.2, 101.0, 102.0]


@pytest.mark.parametrize(("speed", "robot_seconds"), [(0.5, 4.0), (10.0, 0.2)])
def test_sleep_uses_the_time_of_its_clock(follower: Node, speed: float, robot_seconds: float) -> None:
    simulator, clock = Simulator(speed=speed), follower.get_clock()
    thread = threading.Thread(target=spin, args=(9.0, follower, simulator), daemon=True)
    thread.start()
    while not clock.now().nanoseconds:
        Clock().sleep_for(Duration(seconds=0.05))
    began = Clock().now()
    assert clock.sleep_for(Duration(seconds=2))
    assert (Clock().now() - began).nanoseconds * 1e-9 == pytest.approx(robot_seconds, abs=0.1)


def test_time_source_change_ends_a_sleep_with_false(follower: Node) -> None:
    slept: list[bool] = []
    sleeper = threading.Thread(
        target=lambda: slept.append(follower.get_clock().sleep_for(Duration(seconds=5)))
    )
    sleeper.start()
    Clock().sleep_for(Duration(seconds=1))
    follower.set_parameters([ROBOT])
    sleeper.join()
    assert slept == [False]


def test_custom_time_source_sets_the_attached_clocks(node: Node) -> None:
    source, early, late = TimeSource(node=node), ROSClock(), ROSClock()
    source.attach_clock(early)
    late._set_ros_time_is_active(True)
    assert not early.ros_time_is_active
    node.set_parameters([SIM])
    assert early.ros_time_is_active
    say_time(node, 7.0)
    source.attach_clock(late)
    assert [seconds(clock) for clock in (early, late, node.get_clock())] == [7.0, 7.0, 7.0]
    source.detach_node()
    other = Node("other")
    source.attach_node(other)
    other.destroy_node()
    assert not source.ros_time_is_active


class Talker(Node):
    """The official minimal publisher, with a stamp in its text."""

    def __init__(self) -> None:
        super().__init__("minimal_publisher")
        self.publisher_ = self.create_publisher(String, "topic", 10)
        self.timer = self.create_timer(0.5, self.timer_callback)
        self.i = 0

    def timer_callback(self) -> None:
        stamp: TimeMessage = self.get_clock().now().to_msg()
        self.publisher_.publish(String(data=f"Hello World: {self.i} at {stamp.sec}.{stamp.nanosec:09}"))
        self.i += 1


def talked() -> tuple[list[str], str]:
    with use_graph(Graph(end_ns=1_700_000_010 * 10**9)) as graph, record(graph) as recorder:
        rclpy.init(args=["--ros-args", "-p", "use_sim_time:=true"])
        simulator = Simulator(speed=3.0)
        simulator.set_parameters([ROBOT])
        spin(2.0, Talker(), simulator)
        recording = recorder.recording()
        rclpy.shutdown()
    texts: list[Any] = [s.message() for s in recording.samples if s.topic == "/topic"]
    return [message.data for message in texts], recording.digest()


def test_repeated_run_in_sim_time_gives_an_equal_recording(graph: Graph) -> None:
    first, second = talked(), talked()
    assert first[0][:3] == [
        "Hello World: 0 at 100.300000000",
        "Hello World: 1 at 100.600000000",
        "Hello World: 2 at 101.200000000",
    ]
    assert len(first[0]) == 13
    assert first == second
