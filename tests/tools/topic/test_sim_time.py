"""`--use-sim-time`: rates, delays and stamps by /clock."""

from collections.abc import Callable
from itertools import pairwise

import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PointStamped
from rclpy.node import Node
from rosgraph_msgs.msg import Clock

from course_lib.recording import record
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time.driving import running_nodes, spin_for
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import RecordingSource

Run = Callable[[str], str]


@pytest.fixture
def simulator(talker: Node) -> list[float]:
    """Publish /clock ten times a second, from 100 s on and twice as fast; the list changes the next time."""
    now = [100.0]
    node = Node("simulator")
    clock = node.create_publisher(Clock, "/clock", 1)
    place = node.create_publisher(PointStamped, "/sim_place", 1)

    def step() -> None:
        now[0] = round(now[0] + 0.2, 6)
        stamp = Time(sec=int(now[0]), nanosec=round(now[0] % 1 * 1e9))
        point = PointStamped()
        point.header.stamp = stamp
        place.publish(point)
        clock.publish(Clock(clock=stamp))

    node.create_timer(0.1, step)
    running_nodes().append(node)
    return now


def test_rate_is_measured_in_clock_time(run: Run, simulator: list[float]) -> None:
    lines = run("topic hz /chatter --use-sim-time").splitlines()
    assert lines[0].startswith("average rate: 5.")
    assert lines[-3].startswith("average rate: 5.")
    assert len(lines) == 2 * 9 + 1  # once a second of the simulation
    assert run("topic hz /chatter").startswith("average rate: 10.000\n")


def test_delay_is_clock_time_minus_stamp(run: Run, simulator: list[float]) -> None:
    assert run("topic delay /sim_place -s").startswith("average delay: -0.200\n\tmin: -0.200s max: -0.200s")
    assert run("topic delay /sim_place").startswith("average delay: 16999")


def test_bandwidth_is_in_bytes_per_second_of_clock_time(run: Run, simulator: list[float]) -> None:
    by_robot, by_clock = (float(run(f"topic bw /place {o}").splitlines()[-3].split()[0]) for o in ("", "-s"))
    assert by_clock == pytest.approx(by_robot / 2, rel=0.15)


def test_restarted_simulation_is_reported(
    run: Run, simulator: list[float], talker: Node, capsys: pytest.CaptureFixture[str]
) -> None:
    def reset() -> None:
        simulator[0] = -0.2

    talker.create_timer(3.0, reset)
    assert "time has reset, resetting counters\n" in run("topic hz /chatter -s")
    run("topic bw /chatter -s")
    assert "WARNING: time is reset!\n" in capsys.readouterr().err


def test_recording_is_measured_in_its_clock_time(graph: Graph, simulator: list[float]) -> None:
    with record(graph) as recorder:
        spin_for(3.0)
    output: list[str] = []
    ros2(["topic", "hz", "/chatter", "-s"], RecordingSource(recorder.recording()), output.append)
    assert output[-1].startswith("average rate: 5.")


def test_messages_are_published_and_stamped_in_clock_time(
    run: Run, simulator: list[float], talker: Node
) -> None:
    received: list[float] = []
    talker.create_subscription(
        PointStamped,
        "/goal",
        lambda m: received.append(m.header.stamp.sec + m.header.stamp.nanosec * 1e-9),
        10,
    )
    spin_for(0.5)
    run("topic pub -s -r 1 --times 3 /goal geometry_msgs/msg/PointStamped {header: auto}")
    assert [round(b - a, 3) for a, b in pairwise(received)] == [1.0, 1.0]
