"""The robot does what its make says, and number 0 has the three faults that lesson 6 finds."""

from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from rclpy.node import Node

from course_lib.recording import record
from course_lib.robots.unknown_make import Make
from course_lib.robots.unknown_robot import unknown_robot
from course_lib.ros import virtual_time
from course_lib.ros.graph import Graph, use_graph
from course_lib.ros.qos import incompatible
from course_lib.tools.performance.report import PerformanceReport, performance_report


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch) -> Iterator[Graph]:
    monkeypatch.setenv("COURSE_PACE", "fast")
    virtual_time.install()
    with use_graph(Graph(notebook=True)) as graph:
        rclpy.init()
        yield graph


def measured(*nodes: Node) -> PerformanceReport:
    return performance_report(3.0, *nodes)


def unheard(graph: Graph) -> set[str]:
    """The topics with a subscription that some publisher does not reach."""
    ends = graph.endpoints()
    return {
        a.topic
        for a in ends
        for b in ends
        if a.topic == b.topic and (a.kind, b.kind) == ("pub", "sub") and incompatible(a.qos, b.qos)
    }


@pytest.mark.parametrize("serial", [11, 26])
def test_a_robot_is_as_its_make_says(graph: Graph, serial: int) -> None:
    make, nodes = Make(serial), unknown_robot(serial)
    rates = {row.topic: row.rate for row in measured(*nodes).topics}
    assert rates["/robot/front_cam/image_raw"] == pytest.approx(make.image_hz, rel=0.03)
    assert rates["/robot/detections"] == pytest.approx(make.image_hz, rel=0.03)
    assert unheard(graph) == set()
    detector = next(node for node in nodes if node.get_name() == "detector")
    assert detector.get_parameter("threshold").value == make.threshold


def test_number_0_has_a_mismatch_a_wrong_frame_and_a_slow_node(graph: Graph) -> None:
    nodes = unknown_robot()
    assert unheard(graph) == {"/robot/scan"}
    with record(graph) as recorder:
        assert measured(*nodes).busy["/robot/detector"] > 0.5
    sent: dict[str, list[Any]] = {
        topic: [m for _, m in recorder.recording().messages(topic)] for topic in ("/tf_static", "/robot/scan")
    }
    frames = {transform.child_frame_id for message in sent["/tf_static"] for transform in message.transforms}
    assert frames == {"laser_link", "camera_link"}
    assert sent["/robot/scan"][0].header.frame_id not in frames


def test_its_camera_follows_its_parameter_and_refuses_what_is_too_much(graph: Graph) -> None:
    camera = unknown_robot(26)[0]
    (result,) = camera.set_parameters([rclpy.parameter.Parameter("frame_rate", value=5.0)])
    assert result.successful
    assert measured(camera).topics[0].rate == pytest.approx(5.0)
    (result,) = camera.set_parameters([rclpy.parameter.Parameter("frame_rate", value=61.0)])
    assert not result.successful
