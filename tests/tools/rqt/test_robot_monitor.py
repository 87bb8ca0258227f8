from collections.abc import Callable
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node

from course_lib.ros.graph.graph import Graph
from course_lib.ros.time.driving import spin_for
from course_lib.tools.rqt.monitors import RobotMonitorView

Tell = Callable[..., None]


@pytest.fixture
def view(graph: Graph) -> RobotMonitorView:
    view = RobotMonitorView(graph, [])
    view.listen()
    return view


@pytest.fixture
def tell(planner: Node) -> Tell:
    """Publish diagnostic levels by status name."""
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


def test_parent_status_is_the_worst_of_its_children(view: RobotMonitorView, tell: Tell) -> None:
    tell("/diagnostics_agg", Sensors_Camera=1, Sensors_Lidar=0, Motors_elbow=2)
    assert [view.worst_level(path) for path in view.paths()] == ["error", "error", "warn", "warn", "ok"]
    assert "ERROR" in view.picture()


def test_statuses_are_stale_after_five_seconds_without_a_message(
    view: RobotMonitorView, tell: Tell, planner: Node
) -> None:
    tell("/diagnostics", Camera=0)
    spin_for(5.0, planner)
    assert "STALE: the last message" not in view.picture()
    spin_for(0.1, planner)
    assert "STALE: the last message on /diagnostics came 5.1 s ago" in view.picture()


def test_aggregator_status_replaces_the_status_of_the_node(view: RobotMonitorView, tell: Tell) -> None:
    tell("/diagnostics", camera=2)
    tell("/diagnostics_agg", Sensors_camera=0)
    tell("/diagnostics", camera=2)
    assert view.paths() == ["/Sensors", "/Sensors/camera"]


def test_history_is_included_in_the_text(view: RobotMonitorView, tell: Tell) -> None:
    for level in (0, 1, 2):
        tell("/diagnostics_agg", Camera=level)
    assert "The last 3 messages: OK, WARN, ERROR" in view.picture()


def test_selected_status_shows_all_values(view: RobotMonitorView, tell: Tell) -> None:
    tell("/diagnostics_agg", Camera=1)
    view.refresh()
    view.controls["Details of"].value = "/Camera"
    assert "<td>rate</td><td>12</td>" in view.picture()


def test_monitor_shows_the_awaited_topic_before_the_first_message(view: RobotMonitorView) -> None:
    assert "No diagnostics received yet on /diagnostics_agg or /diagnostics" in view.picture()
