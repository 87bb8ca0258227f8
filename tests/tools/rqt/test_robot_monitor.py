from collections.abc import Callable
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from course_lib.ros.driving import spin_for
from course_lib.ros.graph import Graph
from course_lib.tools.rqt.monitors import RobotMonitorView

Tell = Callable[..., None]


@pytest.fixture
def view(graph: Graph) -> RobotMonitorView:
    view = RobotMonitorView(graph, [])
    view.listen()
    return view


@pytest.fixture
def tell(planner: Node) -> Tell:
    """Publishes statuses: their levels by name."""
    publishers: dict[str, Any] = {}

    def tell(topic: str, **levels: int) -> None:
        if topic not in publishers:
            publishers[topic] = planner.create_publisher(DiagnosticArray, topic, 10)
        statuses = [
            DiagnosticStatus(
                name="/" + name.replace("_", "/"),
                level=bytes([level]),
                message=f"level {level}",
                values=[KeyValue(key="rate", value="12")],
            )
            for name, level in levels.items()
        ]
        publishers[topic].publish(DiagnosticArray(status=statuses))

    return tell


def test_a_branch_is_as_bad_as_its_worst_leaf(view: RobotMonitorView, tell: Tell) -> None:
    tell("/diagnostics_agg", Sensors_Camera=1, Sensors_Lidar=0, Motors_elbow=2)
    assert [view.worst(path) for path in view.paths()] == ["error", "error", "warn", "warn", "ok"]
    assert "ERROR" in view.picture()


def test_after_five_seconds_without_a_message_all_is_stale(
    view: RobotMonitorView, tell: Tell, planner: Node
) -> None:
    tell("/diagnostics", Camera=0)
    spin_for(5.0, planner)
    assert "STALE: the last message" not in view.picture()
    spin_for(0.1, planner)
    assert "STALE: the last message on /diagnostics came 5.1 s ago" in view.picture()


def test_the_aggregator_replaces_what_nodes_say_themselves(view: RobotMonitorView, tell: Tell) -> None:
    tell("/diagnostics", camera=2)
    tell("/diagnostics_agg", Sensors_camera=0)
    tell("/diagnostics", camera=2)
    assert view.paths() == ["/Sensors", "/Sensors/camera"]


def test_the_history_is_read_out_too(view: RobotMonitorView, tell: Tell) -> None:
    for level in (0, 1, 2):
        tell("/diagnostics_agg", Camera=level)
    assert "The last 3 messages: OK, WARN, ERROR" in view.picture()


def test_a_chosen_status_tells_all_it_says(view: RobotMonitorView, tell: Tell) -> None:
    tell("/diagnostics_agg", Camera=1)
    view.refresh()
    view.controls["Details of"].value = "/Camera"
    assert "<td>rate</td><td>12</td>" in view.picture()


def test_before_anything_came_it_says_what_it_waits_for(view: RobotMonitorView) -> None:
    assert "No diagnostics heard yet on /diagnostics_agg or /diagnostics" in view.picture()
