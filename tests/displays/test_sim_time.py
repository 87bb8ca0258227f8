"""Views whose time is that on /clock, as RViz's with the parameter `use_sim_time`."""

from collections.abc import Iterator

import pytest
import rclpy
from builtin_interfaces.msg import Duration, Time
from geometry_msgs.msg import PointStamped
from rclpy.node import Node
from rosgraph_msgs.msg import Clock

from course_lib import Viewer
from course_lib.displays.panel.panels import LiveTime
from course_lib.displays.panel.protocol import PublishGesture
from course_lib.displays.panel.tools import publish
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.time.driving import spin_for
from tests.displays.bench import TOPIC, Bench, marker


def say_time(bench: Bench, sim: float, at: float) -> None:
    seconds, nanoseconds = divmod(round(sim * 1e9), 10**9)
    bench.publish("/clock", Clock(clock=Time(sec=seconds, nanosec=nanoseconds)), at=at)
    bench.update(at)


def hints(bench: Bench) -> list[str]:
    return [row.text for row in bench.session.rows() if row.name == "Time"]


@pytest.fixture
def bench() -> Bench:
    bench = Bench()
    bench.session.set_sim_time(True)
    return bench


def test_only_a_viewer_with_sim_time_subscribes_to_the_clock(bench: Bench) -> None:
    assert "/clock" in bench.session.topics()
    bench.session.set_sim_time(False)
    assert "/clock" not in bench.session.topics()


def test_lifetimes_expire_by_the_clock_topic(bench: Bench) -> None:
    say_time(bench, 100.0, at=0.0)
    bench.publish(TOPIC, marker(lifetime=Duration(sec=1)), at=0.1)
    bench.update(20.0)
    assert bench.marker_names() == ["n/0"]
    say_time(bench, 100.9, at=20.1)
    assert bench.marker_names() == ["n/0"]
    say_time(bench, 101.1, at=20.2)
    assert bench.marker_names() == []


def test_backward_clock_jump_resets_the_viewer_as_in_rviz(bench: Bench) -> None:
    say_time(bench, 100.0, at=0.0)
    bench.transform("map", "base", at=0.0, static=False)
    bench.publish(TOPIC, marker(), at=0.1)
    bench.update(0.2)
    say_time(bench, 99.9, at=0.3)
    assert bench.marker_names() == []
    assert bench.session.context.frames.transform("base") is None
    assert hints(bench) == ["RViz's log: Detected jump back in time. Resetting RViz."]


def test_changed_time_source_resets_the_viewer_as_in_rviz(bench: Bench) -> None:
    bench.publish(TOPIC, marker(), at=0.1)
    bench.update(0.2)
    bench.session.set_sim_time(True)
    assert bench.marker_names() == ["n/0"]
    bench.session.set_sim_time(False)
    assert bench.marker_names() == []
    assert hints(bench) == ["RViz's log: Detected time source change. Resetting RViz."]


def test_time_panel_shows_the_clock_time(bench: Bench) -> None:
    time = LiveTime(Graph(), bench.session.time)
    assert (time.time().now, time.time().elapsed) == (0.0, 0.0)
    for sim, at, elapsed in ((100.0, 0.0, 0.0), (102.5, 1.0, 2.5), (50.0, 2.0, 0.0), (51.0, 3.0, 1.0)):
        say_time(bench, sim, at)
        assert (time.time().now, time.time().elapsed) == (sim, elapsed)
    bench.session.set_sim_time(False)
    assert (time.time().now, time.time().elapsed) == (1_700_000_000.0, 0.0)


@pytest.fixture
def simulator(monkeypatch: pytest.MonkeyPatch) -> Iterator[Node]:
    """A node that publishes the time 42 s once a second."""
    monkeypatch.setenv("COURSE_PACE", "fast")
    with use_graph(Graph(notebook=True)):
        rclpy.init()
        node = Node("simulator")
        clock = node.create_publisher(Clock, "/clock", 1)
        node.create_timer(1.0, lambda: clock.publish(Clock(clock=Time(sec=42))))
        yield node
        rclpy.shutdown()


def test_viewer_with_sim_time_follows_the_clock_and_uses_it_for_stamps(simulator: Node) -> None:
    viewer, messages = Viewer(use_sim_time=True), list[PointStamped]()
    marker_display = viewer.add("Marker", "/marker")
    simulator.create_subscription(PointStamped, "/clicked_point", messages.append, 10)
    spin_for(1.5, simulator)
    click = PublishGesture("Publish Point", (1.0, 2.0, 0.0), 0.0)
    assert viewer.session.context.node is not None
    publish(viewer.session.context.node, viewer.session.tools, "map", click)
    spin_for(0.5, simulator)
    assert messages[0].header.stamp == Time(sec=42)
    assert marker_display.context.now_ns == 42 * 10**9
    assert viewer.use_sim_time
    viewer.use_sim_time = False
    assert marker_display.context.now_ns > 42 * 10**9
