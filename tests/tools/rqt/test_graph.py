import re

import pytest
from control_msgs.action import GripperCommand
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.ros.graph import Graph
from course_lib.tools.rqt.graph import ACTIVE, ALL, NODES, GraphView, passes


def drawn(view: GraphView) -> list[str]:
    """Return the words in the picture."""
    return re.findall("<text[^>]*>([^<]*)<", view.picture())


def shapes(view: GraphView, name: str) -> int:
    return view.picture().count(f"<{name} ")


def test_nodes_are_ellipses_and_topics_with_both_ends_are_boxes(
    graph: Graph, arm: Node, planner: Node
) -> None:
    view = GraphView(graph, [])
    assert view["Show"] == ACTIVE
    view.controls["Group namespaces"].value = False
    assert sorted(drawn(view)) == ["/arm/controller", "/arm/joint_states", "/planner"]
    assert (shapes(view, "ellipse"), shapes(view, "rect")) == (2, 1)


def test_all_shows_topics_that_nobody_hears(graph: Graph, arm: Node, planner: Node) -> None:
    view = GraphView(graph, [])
    view.controls["Show"].value = ALL
    assert "/plan" in drawn(view)
    view.controls["Hide Dead sinks"].value = True
    assert "/plan" not in drawn(view)


def test_nodes_only_writes_topics_on_the_arrows(graph: Graph, arm: Node, planner: Node) -> None:
    view = GraphView(graph, [])
    view.controls["Show"].value = NODES
    view.controls["Group namespaces"].value = False
    assert (shapes(view, "ellipse"), shapes(view, "rect")) == (2, 0)
    assert "/arm/joint_states" in drawn(view)
    assert "/arm/controller to /planner /arm/joint_states" in view.picture()


def test_debug_and_parameters_are_hidden_until_asked_for(graph: Graph, arm: Node) -> None:
    view = GraphView(graph, [])
    view.controls["Show"].value = ALL
    assert not {"/rosout", "/parameter_events"} & set(drawn(view))
    for name in ("Hide Debug", "Hide Params"):
        view.controls[name].value = False
    assert {"/rosout", "/parameter_events"} <= set(drawn(view))


def test_a_topic_whose_qos_does_not_fit_says_so_in_words(graph: Graph, planner: Node) -> None:
    weak = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    Node("camera").create_publisher(String, "label", weak)
    planner.create_subscription(String, "label", lambda _: None, 10)
    view = GraphView(graph, [])
    assert "/label (QoS!)" in drawn(view)
    view.controls["Show"].value = NODES
    assert "/label (QoS!)" in drawn(view)


def test_the_topics_of_an_action_do_not_mismatch_each_other(graph: Graph, planner: Node) -> None:
    server = ActionServer(Node("hand"), GripperCommand, "grip", lambda _: GripperCommand.Result())
    client = ActionClient(planner, GripperCommand, "grip")
    view = GraphView(graph, [])
    for view.controls["Show"].value in (ACTIVE, NODES):
        assert "/grip/action_topics" in drawn(view)
        assert "/grip/action_topics (QoS!)" not in drawn(view)
    client.destroy()
    server.destroy()


def test_namespaces_are_groups(graph: Graph, arm: Node, planner: Node) -> None:
    assert "/arm" in drawn(GraphView(graph, []))


def test_filters_take_patterns_and_exceptions() -> None:
    names = ["/arm/a", "/arm/b", "/leg"]
    assert [name for name in names if passes(name, "/")] == names
    assert [name for name in names if passes(name, "/arm/.*, -/arm/b")] == ["/arm/a"]
    with pytest.raises(CourseError, match=r"'\(\[' is not a filter"):
        passes("/a", "([")


def test_without_nodes_it_says_what_to_do(graph: Graph) -> None:
    assert "No node is there" in GraphView(graph, []).picture()
