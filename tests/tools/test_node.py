from collections.abc import Callable

import pytest
from rclpy.node import Node
from std_srvs.srv import Trigger

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros.graph.graph import Graph
from course_lib.ros.graph.topics import Qos
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import RecordingSource

Run = Callable[[str], str]


def test_list_prints_nodes_and_warns_about_duplicate_names(
    run: Run, graph: Graph, talker: Node, capsys: pytest.CaptureFixture[str]
) -> None:
    other = Node("arm", namespace="robot")
    hidden = Node("_hidden")
    assert run("node list") == "/robot/arm\n/talker\n"
    assert run("node list -a") == "/_hidden\n/robot/arm\n/talker\n"
    assert run("node list -c") == "2\n"
    graph.add_node("talker", "/")  # as from another process, because a notebook replaces its own nodes
    assert run("node list") == "/robot/arm\n/talker\n/talker\n"
    assert capsys.readouterr().err == (
        "WARNING: Be aware that there are nodes in the graph that share an exact name, which can have "
        "unintended side effects.\n"
    )
    assert run("node info /talker").startswith("/talker\n  Subscribers:\n")
    assert capsys.readouterr().err == (
        'There are 2 nodes in the graph with the exact name "/talker". You are seeing information about '
        "only one of them.\n"
    )
    del other, hidden


def test_info_has_the_sections_of_ros2cli(run: Run, graph: Graph) -> None:
    node = graph.add_node("talker", "/")
    string = "std_msgs/msg/String"
    graph.add_publisher(node, "/chatter", string, Qos())
    graph.add_publisher(node, "/_secret", string, Qos())
    graph.add_publisher(node, "/_secret", string, Qos())
    action = "/move/_action/feedback"
    graph.add_publisher(node, action, "example_interfaces/action/Fibonacci_FeedbackMessage", Qos())
    assert run("node info /talker") == (
        "/talker\n  Subscribers:\n\n  Publishers:\n    /chatter: std_msgs/msg/String\n"
        "  Service Servers:\n\n  Service Clients:\n\n"
        "  Action Servers:\n    /move: example_interfaces/action/Fibonacci\n  Action Clients:\n\n"
    )
    assert "    /_secret: std_msgs/msg/String\n    /chatter" in run("node info /talker --include-hidden")


def test_info_distinguishes_servers_and_clients(run: Run, talker: Node) -> None:
    talker.create_service(Trigger, "reset", lambda _, response: response)
    asker = Node("asker", start_parameter_services=False, enable_rosout=False)
    asker.create_client(Trigger, "reset")
    assert "  Service Servers:\n    /reset: std_srvs/srv/Trigger\n    /talker/desc" in run(
        "node info /talker"
    )
    servers, clients = (
        run("node info /asker").partition("  Service Servers:\n")[2].split("  Service Clients:\n")
    )
    assert servers == "    /asker/get_type_description: type_description_interfaces/srv/GetTypeDescription\n"
    assert clients.startswith("    /reset: std_srvs/srv/Trigger\n")


def test_unknown_node_error_suggests_the_closest(run: Run, talker: Node) -> None:
    with pytest.raises(CourseError, match=r"^Unable to find node 'talker'\. Did you mean /talker\?$"):
        run("node info talker")


def test_node_list_of_a_recording_has_the_player_node() -> None:
    output: list[str] = []
    ros2(["node", "list"], RecordingSource(Recording(())), output.append)
    assert output == ["/rosbag2_player\n"]
