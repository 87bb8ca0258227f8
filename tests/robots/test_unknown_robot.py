"""The robot behaves according to its configuration; number 0 has the three faults of lesson 6."""

from collections.abc import Iterator
from typing import Any

import pytest
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Image

from course_lib.errors import CourseError
from course_lib.grading.task import shipped_catalog
from course_lib.grading.vocabulary.topics import DIGESTS, TOOLS, digest, is_fact
from course_lib.recording import record
from course_lib.robots.unknown_robot import unknown_robot
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.graph.topics import find_incompatible_policy
from course_lib.ros.time import virtual_time
from course_lib.ros.time.driving import spin_for
from course_lib.tools.performance import PerformanceReport, performance_report


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
        if a.topic == b.topic
        and (a.kind, b.kind) == ("pub", "sub")
        and find_incompatible_policy(a.qos, b.qos)
    }


class Inspector(Node):
    """Determines the facts that week 6 asks for with the command-line tools."""

    def __init__(self) -> None:
        super().__init__("inspector")
        self.times, self.widths = list[int](), set[int]()  # [ns], [px]
        self.create_subscription(Image, "/robot/front_cam/image_raw", self.see, qos_profile_sensor_data)
        self.parameters = AsyncParameterClient(self, "/robot/detector")

    def see(self, image: Image) -> None:
        self.times.append(self.get_clock().now().nanoseconds)
        self.widths.add(image.width)


def looked_at(serial: int) -> dict[str, Any]:
    """Return the facts that week 6 asks for, measured on a running robot."""
    inspector, nodes = Inspector(), unknown_robot(serial)
    spin_for(2.0, inspector, *nodes)  # [s]
    asked: Any = inspector.parameters.get_parameters(["threshold"])
    spin_for(0.5, inspector, *nodes)  # [s]
    (scans,) = inspector.get_publishers_info_by_topic("/robot/scan")
    services = inspector.get_service_names_and_types()
    return {
        "image_rate": (len(inspector.times) - 1) / (inspector.times[-1] - inspector.times[0]) * 1e9,
        "image_width": max(inspector.widths),
        "scan_reliability": scans.qos_profile.reliability.name,
        "threshold": asked.result().values[0].double_value,
        "trigger_service": next(name for name, types in services if "std_srvs/srv/Trigger" in types),
    }


def test_table_contains_the_properties_of_every_assignable_robot(graph: Graph) -> None:
    assert set(shipped_catalog().task("week06.robot_facts").personal["serial"]) == set(DIGESTS)


@pytest.mark.parametrize("serial", DIGESTS)
def test_robot_agrees_with_the_table(graph: Graph, serial: int) -> None:
    facts = looked_at(serial)
    assert list(facts) == list(TOOLS)
    meant = facts | {"image_rate": round(facts["image_rate"])}
    assert tuple(digest(serial, name, value) for name, value in meant.items()) == DIGESTS[serial]
    assert all(is_fact(serial, name, value) for name, value in facts.items())
    assert unheard(graph) == set()


def test_student_robot_never_has_the_properties_of_the_lesson_robot(graph: Graph) -> None:
    lesson = {
        "image_rate": 30,
        "image_width": 64,
        "threshold": 0.5,
        "trigger_service": "/robot/reset_odometry",
    }
    for serial in DIGESTS:
        assert [name for name, value in lesson.items() if is_fact(serial, name, value)] == []


def test_inactive_robot_reveals_nothing(graph: Graph) -> None:
    camera, detector, _, base, *_ = unknown_robot(26)
    assert camera.get_parameter("frame_rate").value == 30.0
    assert detector.get_parameter("threshold").value == 0.5
    assert not any("Trigger" in str(types) for _, types in base.get_service_names_and_types())
    assert base.get_publishers_info_by_topic("/robot/scan") == []
    with pytest.raises(CourseError, match="This robot is not running"):
        vars(type(camera))["begin"](camera)


def test_robot_0_has_a_qos_mismatch_a_wrong_frame_and_a_slow_node(graph: Graph) -> None:
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


def test_camera_applies_its_parameter_and_rejects_large_values(graph: Graph) -> None:
    camera = unknown_robot(26)[0]
    spin_for(0.1, camera)  # [s]
    (result,) = camera.set_parameters([rclpy.parameter.Parameter("frame_rate", value=5.0)])
    assert result.successful
    assert measured(camera).topics[0].rate == pytest.approx(5.0)
    (result,) = camera.set_parameters([rclpy.parameter.Parameter("frame_rate", value=61.0)])
    assert not result.successful


def test_camera_logs_a_new_rate_and_no_other_parameter(
    graph: Graph, capfd: pytest.CaptureFixture[str]
) -> None:
    camera = next(node for node in unknown_robot(0) if node.get_name() == "camera_driver")
    capfd.readouterr()
    for name, value in (("frame_id", "lens"), ("use_sim_time", False), ("frame_rate", 15.0)):
        assert camera.set_parameters([Parameter(name, value=value)])[0].successful
    assert capfd.readouterr().err.count("images per second") == 1
