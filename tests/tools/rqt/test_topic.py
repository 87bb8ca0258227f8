import re

from rclpy.node import Node

from course_lib.recording import record
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time.driving import spin_for
from course_lib.tools.rqt.monitors import TopicView


def test_rates_and_sizes_agree_with_published_messages(graph: Graph, arm: Node) -> None:
    view = TopicView(graph, [])
    view.listen()
    with record(graph) as recorder:
        spin_for(2.0)
    size = next(len(s.cdr) for s in recorder.recording().samples if s.topic == "/arm/joint_states")
    assert view.cells("/arm/joint_states", ["sensor_msgs/msg/JointState"])[:3] == [
        "sensor_msgs/msg/JointState",
        f"{size * 20 / 1000:.2f} KB/s",
        "20.00",
    ]


def test_row_expands_to_the_complete_value(graph: Graph, arm: Node) -> None:
    view = TopicView(graph, ["/arm/joint_states"])
    view.listen()
    spin_for(0.2)
    view.refresh()
    line, value = view.rows["/arm/joint_states"].children
    assert "position:\n- " in value.value
    line.children[0].value = False
    assert value.value == ""


def test_cells_of_a_row_are_separate_words_without_the_style(graph: Graph, arm: Node) -> None:
    view = TopicView(graph, [])
    view.listen()
    spin_for(2.0)
    view.refresh()
    line, _ = view.rows["/arm/joint_states"].children
    words = re.sub(r"<[^>]+>", "", line.children[1].value).split()
    assert words[0] == "sensor_msgs/msg/JointState"
    assert words[2:4] == ["KB/s", "20.00"]


def test_filter_hides_topics(graph: Graph, arm: Node) -> None:
    view = TopicView(graph, [])
    view.controls["Filter"].value = "joint"
    view.refresh()
    assert len(view.table.children) == 1
    assert "no message yet" in view.picture()
