"""`~/get_type_description`, which every node of Jazzy has."""

import hashlib
import json
from typing import Any

import pytest
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import String
from std_srvs.srv import Trigger
from type_description_interfaces.msg import IndividualTypeDescription
from type_description_interfaces.srv import GetTypeDescription
from visualization_msgs.msg import Marker

from course_lib.ros.graph.graph import Graph
from course_lib.ros.messages.definitions import type_hash


@pytest.fixture
def used(started_graph: Graph) -> Node:
    node = Node("used")
    node.create_publisher(Marker, "marker", 1)
    node.create_service(Trigger, "start", lambda request, response: response)
    return node


def ask(node: Node, **request: Any) -> GetTypeDescription.Response:
    asker = Node("asker")
    client = asker.create_client(GetTypeDescription, "/used/get_type_description")
    future = client.call_async(GetTypeDescription.Request(**request))
    executor = rclpy.get_global_executor()
    executor.add_node(node)
    executor.add_node(asker)
    executor.spin_until_future_complete(future)
    answer = future.result()
    assert isinstance(answer, GetTypeDescription.Response)
    return answer


def plain(description: IndividualTypeDescription) -> dict[str, Any]:
    names = ("type_id", "capacity", "string_capacity", "nested_type_name")
    fields = [
        {"name": field.name, "type": {name: getattr(field.type, name) for name in names}}
        for field in description.fields
    ]
    return {"type_name": description.type_name, "fields": fields}


@pytest.mark.parametrize("name", ["visualization_msgs/msg/Marker", "std_srvs/srv/Trigger"])
def test_type_description_has_the_requested_hash(used: Node, name: str) -> None:
    answer = ask(used, type_name=name, type_hash=type_hash(name))
    assert answer.successful
    described = answer.type_description
    text = json.dumps(
        {
            "type_description": plain(described.type_description),
            "referenced_type_descriptions": [plain(one) for one in described.referenced_type_descriptions],
        }
    )
    assert f"RIHS01_{hashlib.sha256(text.encode()).hexdigest()}" == type_hash(name)


def test_service_whose_event_type_is_in_use_is_described(used: Node) -> None:
    # The first use of the event type adds it to the known definitions.
    Trigger.Event()
    name = "std_srvs/srv/Trigger"
    answer = ask(used, type_name=name, type_hash=type_hash(name))
    assert {"std_srvs/srv/Trigger_Request", "std_srvs/srv/Trigger_Response"} <= {
        one.type_name for one in answer.type_sources
    }


def test_type_sources_are_included_on_request(used: Node) -> None:
    wanted = {
        "type_name": "visualization_msgs/msg/Marker",
        "type_hash": type_hash("visualization_msgs/msg/Marker"),
    }
    sources = {one.type_name: one for one in ask(used, **wanted).type_sources}
    assert "int32 SPHERE=2" in sources["visualization_msgs/msg/Marker"].raw_file_contents
    assert "float64 x" in sources["geometry_msgs/msg/Point"].raw_file_contents
    assert ask(used, **wanted, include_type_sources=False).type_sources == []


@pytest.mark.parametrize(
    ("asked", "reason"),
    [
        ("", "Failed to parse type hash"),
        (type_hash("std_msgs/msg/Bool"), "Type not currently in use by this node"),
    ],
)
def test_failure_reason_has_the_text_of_rcl(used: Node, asked: str, reason: str) -> None:
    answer = ask(used, type_name="std_msgs/msg/Bool", type_hash=asked)
    assert (answer.successful, answer.failure_reason) == (False, reason)


def test_parameter_disables_the_service_and_is_read_only(started_graph: Graph) -> None:
    name = "start_type_description_service"
    quiet = Node("quiet", parameter_overrides=[Parameter(name, value=False)])
    quiet.create_publisher(String, "words", 1)
    found = {service for service, _ in quiet.get_service_names_and_types()}
    assert "/quiet/get_parameters" in found
    assert "/quiet/get_type_description" not in found
    assert not quiet.set_parameters([Parameter(name, value=True)])[0].successful
