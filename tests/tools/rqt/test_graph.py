import re

import pytest
from control_msgs.action import GripperCommand
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph
from course_lib.tools.rqt.graph import ACTIVE, ALL, NODES, GraphView, matches_filter


def labels_of(view: GraphView) -> list[str]:
    """Return the labels in the picture."""
    return re.findall("<text[^>]*>([^<]*)<", view.picture())


def shapes(view: GraphView, name: str) -> int:
    return view.picture().count(f"<{name} ")


def test_nodes_are_ellipses_and_connected_topics_are_boxes(graph: Graph, arm: Node, planner: Node) -> None:
    view = GraphView(graph, [])
    assert view["Show"] == ACTIVE
    view.controls["Group namespaces"].value = False
    assert sorted(labels_of(view)) == ["/arm/controller", "/arm/joint_states", "/planner"]
    assert (shapes(view, "ellipse"), shapes(view, "rect")) == (2, 1)


def test_all_option_shows_topics_without_subscription(graph: Graph, arm: Node, planner: Node) -> None:
    view = GraphView(graph, [])
    view.controls["Show"].value = ALL
    assert "/plan" in labels_of(view)
    view.controls["Hide Dead sinks"].value = True
    assert "/plan" not in labels_of(view)


def test_nodes_only_option_labels_arrows_with_topics(graph: Graph, arm: Node, planner: Node) -> None:
    view = GraphView(graph, [])
    view.controls["Show"].value = NODES
    view.controls["Group namespaces"].value = False
    assert (shapes(view, "ellipse"), shapes(view, "rect")) == (2, 0)
    assert "/arm/joint_states" in labels_of(view)
    assert "/arm/controller to /planner /arm/joint_states" in view.picture()


def test_debug_nodes_and_parameters_are_hidden_by_default(graph: Graph, arm: Node) -> None:
    view = GraphView(graph, [])
    view.controls["Show"].value = ALL
    assert not {"/rosout", "/parameter_events"} & set(labels_of(view))
    for name in ("Hide Debug", "Hide Params"):
        view.controls[name].value = False
    assert {"/rosout", "/parameter_events"} <= set(labels_of(view))


def test_incompatible_qos_is_explained(graph: Graph, planner: Node) -> None:
    weak = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    Node("camera").create_publisher(String, "label", weak)
    planner.create_subscription(String, "label", lambda _: None, 10)
    view = GraphView(graph, [])
    assert "/label (QoS!)" in labels_of(view)
    view.controls["Show"].value = NODES
    assert "/label (QoS!)" in labels_of(view)


def test_qos_of_the_topics_of_an_action_is_compatible(graph: Graph, planner: Node) -> None:
    server = ActionServer(Node("hand"), GripperCommand, "grip", lambda _: GripperCommand.Result())
    client = ActionClient(planner, GripperCommand, "grip")
    view = GraphView(graph, [])
    for view.controls["Show"].value in (ACTIVE, NODES):
        assert "/grip/action_topics" in labels_of(view)
        assert "/grip/action_topics (QoS!)" not in labels_of(view)
    client.destroy()
    server.destroy()


def test_namespaces_are_drawn_as_groups(graph: Graph, arm: Node, planner: Node) -> None:
    assert "/arm" in labels_of(GraphView(graph, []))


def test_filters_accept_patterns_and_exclusions() -> None:
    names = ["/arm/a", "/arm/b", "/leg"]
    assert [name for name in names if matches_filter(name, "/")] == names
    assert [name for name in names if matches_filter(name, "/arm/.*, -/arm/b")] == ["/arm/a"]
    with pytest.raises(CourseError, match=r"'\(\[' is not a filter"):
        matches_filter("/a", "([")


def test_graph_without_nodes_prints_a_hint(graph: Graph) -> None:
    assert "There is no node" in GraphView(graph, []).picture()
