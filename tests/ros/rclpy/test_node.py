import gc
from typing import Any

import pytest
import rclpy
from rclpy.exceptions import (
    InvalidNamespaceException,
    InvalidNodeNameException,
    InvalidParameterTypeException,
    InvalidTopicNameException,
    ParameterAlreadyDeclaredException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import Int32, String
from std_srvs.srv import Trigger

from course_lib.ros.graph.graph import Graph


def test_node_returns_its_name_namespace_and_fully_qualified_name(started_graph: Graph) -> None:
    node = Node("talker", namespace="robot/left")
    assert node.get_name() == "talker"
    assert node.get_namespace() == "/robot/left"
    assert node.get_fully_qualified_name() == "/robot/left/talker"
    assert node.get_logger().name == "robot.left.talker"
    assert Node("leader").get_fully_qualified_name() == "/leader"


def test_invalid_node_name_or_namespace_is_rejected_as_in_ros(started_graph: Graph) -> None:
    with pytest.raises(
        InvalidNodeNameException, match="must not contain characters other than alphanumerics"
    ):
        Node("my node")
    with pytest.raises(InvalidNamespaceException, match="must not have a token that starts with a number"):
        Node("talker", namespace="2nd")
    assert started_graph.nodes() == []


def test_every_node_has_the_topics_rosout_and_parameter_events(node: Node) -> None:
    assert node.get_topic_names_and_types() == [
        ("/parameter_events", ["rcl_interfaces/msg/ParameterEvent"]),
        ("/rosout", ["rcl_interfaces/msg/Log"]),
    ]
    info = node.get_publishers_info_by_topic("/rosout")[0]
    assert (info.node_name, info.qos_profile.durability.name) == ("talker", "TRANSIENT_LOCAL")


def test_unreferenced_node_stays_in_the_graph(node: Node) -> None:
    rclpy.create_node("dropped")
    gc.collect()
    assert node.get_node_names() == ["talker", "dropped"]


def test_invalid_topic_name_is_rejected_as_in_ros(node: Node) -> None:
    with pytest.raises(InvalidTopicNameException) as caught:
        node.create_publisher(String, "x/", 10)
    text = "Invalid topic name: topic name must not end with a forward slash:\n  'x/'\n   ^"
    assert str(caught.value).startswith(text[:-1])


def test_invalid_qos_is_rejected_as_in_ros(node: Node) -> None:
    with pytest.raises(TypeError, match=r"^Expected QoSProfile or int, but received <class 'str'>$"):
        node.create_publisher(String, "x", "10")  # type: ignore[arg-type]  # the mistake under test
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'qos_profile'"):
        node.create_publisher(String, "x")  # type: ignore[call-arg]  # the mistake under test
    with pytest.raises(ValueError, match=r"^history depth must be greater than or equal to zero$"):
        node.create_subscription(String, "x", print, -1)


def test_invalid_message_type_is_rejected_as_in_ros(node: Node) -> None:
    kind: Any = String()
    publisher = node.create_publisher(kind, "x", 10)
    with pytest.raises(TypeError, match=r"^isinstance\(\) arg 2 must be a type"):
        publisher.publish(String())
    with pytest.raises(AttributeError, match="ROS 1 message type but it should be a ROS 2 message type"):
        node.create_publisher(int, "x", 10)  # type: ignore[type-var]  # the mistake under test
    with pytest.raises(AttributeError, match="type object 'str' has no attribute '_TYPE_SUPPORT'"):
        node.create_subscription("std_msgs/String", "x", print, 10)  # type: ignore[arg-type]  # likewise


def test_node_lists_the_graph(node: Node) -> None:
    other = Node("other", namespace="/far")
    node.create_publisher(String, "chatter", 10)
    other.create_subscription(String, "/chatter", print, 10)
    assert node.get_node_names() == ["talker", "other"]
    assert node.get_node_names_and_namespaces() == [("talker", "/"), ("other", "/far")]
    assert (node.count_publishers("chatter"), node.count_subscribers("chatter")) == (1, 1)
    assert ("/chatter", ["std_msgs/msg/String"]) in node.get_topic_names_and_types()
    (heard,) = node.get_subscriptions_info_by_topic("/chatter")
    assert (heard.node_name, heard.node_namespace, heard.endpoint_type.name) == (
        "other",
        "/far",
        "SUBSCRIPTION",
    )


def test_private_topics_have_the_node_name_and_relative_topics_the_namespace(started_graph: Graph) -> None:
    node = Node("talker", namespace="/robot")
    assert node.create_publisher(String, "~/state", 10).topic_name == "/robot/talker/state"
    assert node.create_publisher(String, "state", 10).topic_name == "/robot/state"
    assert node.create_publisher(String, "/state", 10).topic_name == "/state"
    assert node.resolve_topic_name("state") == "/robot/state"


def test_destroy_node_removes_its_entities_and_is_idempotent(node: Node, started_graph: Graph) -> None:
    node.create_publisher(String, "chatter", 10)
    node.create_subscription(String, "chatter", print, 10)
    node.create_timer(1.0, print)
    node.destroy_node()
    node.destroy_node()
    assert (started_graph.nodes(), started_graph.endpoints()) == ([], [])
    assert [*node.publishers, *node.subscriptions, *node.timers] == []


def test_creating_and_destroying_a_node_does_not_search_the_whole_graph(
    started_graph: Graph, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        started_graph, "endpoints", pytest.fail
    )  # a worker's graph asks another process for it
    node = Node("talker")
    node.create_publisher(String, "chatter", 10)
    node.create_subscription(String, "chatter", print, 10)
    node.create_service(Trigger, "start", print)
    node.create_client(Trigger, "start")
    assert node.count_subscribers("chatter") == 1
    node.destroy_node()


def test_destroy_node_succeeds_after_its_entities_are_destroyed(node: Node) -> None:
    made = (
        node.create_publisher(String, "x", 1),
        node.create_subscription(String, "x", lambda _: None, 1),
        node.create_timer(1.0, lambda: None),
    )
    for entity in made:
        entity.destroy()
        entity.destroy()
    node.destroy_node()


def test_node_does_not_destroy_entities_of_another_node(node: Node) -> None:
    publisher = Node("other").create_publisher(String, "x", 10)
    assert not node.destroy_publisher(publisher)
    subscription = node.create_subscription(String, "x", print, 10)
    assert node.destroy_subscription(subscription)
    assert not node.destroy_subscription(subscription)


def test_duplicate_node_name_causes_a_warning_as_in_ros(
    node: Node, capsys: pytest.CaptureFixture[str]
) -> None:
    Node("talker")
    assert node.get_node_names() == ["talker", "talker"]
    assert capsys.readouterr().err == (
        "[WARN] [1700000000.000000000] [rcl.logging_rosout]: Publisher already registered for node name: "
        "'talker'. If this is due to multiple nodes with the same name then all logs for the logger named "
        "'talker' will go out over the existing publisher. As soon as any node with that name is destructed "
        "it will unregister the publisher, preventing any further logs for that name from being published on "
        "the rosout topic.\n"
    )


def test_parameters_are_declared_and_read(node: Node) -> None:
    assert node.declare_parameter("speed", 1.5).value == 1.5
    assert node.get_parameter("speed").value == 1.5
    assert node.get_parameter("speed").get_parameter_value().double_value == 1.5
    assert node.has_parameter("speed")
    assert node.get_parameter("use_sim_time").value is False
    assert Parameter.from_parameter_msg(node.get_parameter("speed").to_parameter_msg()).value == 1.5


def test_invalid_parameter_calls_are_rejected_as_in_ros(node: Node) -> None:
    with pytest.raises(
        ParameterNotDeclaredException, match=r"^Invalid access to undeclared parameter\(s\): x$"
    ):
        node.get_parameter("x")
    node.declare_parameter("x", 1)
    with pytest.raises(
        ParameterAlreadyDeclaredException, match=r"^Parameter\(s\) already declared: \['x'\]$"
    ):
        node.declare_parameter("x", 1)
    node.declare_parameter("y", Parameter.Type.INTEGER)
    with pytest.raises(ParameterUninitializedException, match=r"^The parameter 'y' is not initialized: y$"):
        node.get_parameter("y")
    with pytest.warns(UserWarning, match="declaring a parameter only providing its name is deprecated"):
        node.declare_parameter("z")
    with pytest.raises(TypeError, match=r"^The given value is not one of the allowed types"):
        node.declare_parameter("w", Int32())


def test_overrides_take_precedence_over_defaults_if_their_type_matches(started_graph: Graph) -> None:
    overrides = [Parameter("speed", value=2.0), Parameter("name", value="a")]
    node = rclpy.create_node("talker", parameter_overrides=overrides)
    assert node.declare_parameter("speed", 1.0).value == 2.0
    text = "Trying to set parameter 'name' to 'a' of type 'STRING', expecting type 'INTEGER': name"
    with pytest.raises(InvalidParameterTypeException, match=f"^{text}$"):
        node.declare_parameter("name", 1)


def test_parameter_services_have_the_name_that_an_overridden_method_returns(started_graph: Graph) -> None:
    class Renamed(Node):
        def get_name(self) -> str:
            return "cube"

    services = {name for name, _ in Renamed("talker").get_service_names_and_types()}
    # As measured with rclpy, whose type description service asks its node otherwise.
    assert {"/cube/set_parameters", "/talker/get_type_description"} <= services
    assert "/talker/set_parameters" not in services
