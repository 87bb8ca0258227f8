"""The time of a bag on /clock, for nodes with `use_sim_time`."""

from collections.abc import Callable
from pathlib import Path

import pytest
from builtin_interfaces.msg import Time
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.recording import read_bag
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time.driving import running_nodes, spin_for
from tests.tools.bag.conftest import BAG_START

Run = Callable[[str], str]
NS = 10**9


def in_bag(ns: int) -> float:
    return round((ns - BAG_START) / NS, 3)


def time_of(stamp: Time) -> int:
    return stamp.sec * NS + stamp.nanosec


@pytest.fixture
def events(graph: Graph) -> list[object]:
    """Times on /clock, in seconds of the bag, and texts, in the order of their arrival."""
    events: list[object] = []
    node = Node("watch")
    node.create_subscription(
        Clock, "/clock", lambda m: events.append(in_bag(time_of(m.clock))), qos_profile_sensor_data
    )
    for topic in ("/a", "/b"):
        node.create_subscription(String, topic, lambda m: events.append(m.data), 10)
    running_nodes().append(node)
    return events


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ("--clock 1 -l --playback-duration 1", [0.0, "0", 1.0, "1"] * 5),
        ("--clock 0.5", [0.0, "0", "1", 2.0, "2", "3", 4.0, "4", "5"]),
        ("--clock 1 -r 2", [0.0, "0", "1", 2.0, "2", "3", 4.0, "4", "5"]),
        ("--clock-topics /b", ["0", 1.0, "1", "2", 3.0, "3", "4", 5.0, "5"]),
        ("--clock-topics-all --start-offset 3", [3.0, "3", 4.0, "4", 5.0, "5"]),
        ("--clock-topics /b --topics /a", ["0", "2", "4"]),
    ],
)
def test_bag_time_is_published_at_a_rate_or_before_messages(
    bag: Path, run: Run, events: list[object], options: str, expected: list[object]
) -> None:
    run(f"play five {options}")
    assert events[: len(expected)] == expected
    assert "-l" in options or len(events) == len(expected)


def test_clock_is_published_at_40_hz_by_default(bag: Path, run: Run, events: list[object]) -> None:
    run("play five --clock")
    assert sum(isinstance(event, float) for event in events) == 5 * 40 + 1


def test_clock_is_published_with_the_clock_qos_of_rclcpp(bag: Path, graph: Graph, run: Run) -> None:
    observed: list[QoSProfile] = []
    node = Node("watch")
    node.create_timer(
        2.0, lambda: observed.extend(i.qos_profile for i in node.get_publishers_info_by_topic("/clock"))
    )
    running_nodes().append(node)
    run("play five --clock")
    assert observed[0].reliability is ReliabilityPolicy.BEST_EFFORT


@pytest.mark.parametrize("two", ["--clock --clock-topics /a", "--clock-topics-all --clock-topics /a"])
def test_clock_options_are_mutually_exclusive(bag: Path, run: Run, two: str) -> None:
    with pytest.raises(CourseError, match=r"argument --clock-topics: not allowed with argument --clock"):
        run(f"play five {two}")


def test_node_with_sim_time_follows_the_time_of_the_bag(bag: Path, graph: Graph, run: Run) -> None:
    node, calls, received = (
        Node("follower", parameter_overrides=[Parameter("use_sim_time", value=True)]),
        [],
        [],
    )
    clock = node.get_clock()
    node.create_subscription(
        String, "/a", lambda m: received.append((in_bag(clock.now().nanoseconds), m.data)), 10
    )
    timer = node.create_timer(2.0, lambda: calls.append(in_bag(clock.now().nanoseconds)))
    running_nodes().append(node)
    spin_for(10.0, node)
    assert calls == []
    run("play five --clock 10 -r 4 --start-offset 1")
    assert received == [(1.8, "2"), (3.8, "4")]
    assert calls == [1.0, 2.2, 4.2]
    assert timer.time_until_next_call() == 1_000_000_000


def test_recording_in_sim_time_has_the_stamps_of_the_clock(bag: Path, graph: Graph, run: Run) -> None:
    simulator, latched = Node("simulator"), Node("map_server")
    clock = simulator.create_publisher(Clock, "/clock", 1)
    words = simulator.create_publisher(String, "/words", 1)
    sent = iter(range(1, 1000))

    def step() -> None:
        words.publish(String(data="hi"))
        if (number := next(sent)) > 4:
            clock.publish(Clock(clock=Time(sec=number)))

    simulator.create_timer(0.5, step)
    running_nodes().extend([simulator, latched])
    output = run("record -o out --use-sim-time --topics /words /clock")
    recording = read_bag(Path("out"))
    assert [(s.topic, s.stamp_ns // NS) for s in recording.samples][:5] == [
        ("/clock", 5),
        ("/words", 5),
        ("/clock", 6),
        ("/words", 6),
        ("/clock", 7),
    ]
    lines = [line.partition("]: ")[2] for line in output.splitlines()]
    assert lines[:3] == [
        "Listening for topics...",
        "Recording...",
        "use_sim_time set, waiting for /clock before starting recording...",
    ]
    found = lines.index("Sim time /clock found, starting recording.")
    assert {line for line in lines[:found] if "Subscribed" in line} == set()
    assert "Subscribed to topic '/words'" in lines[found:]
