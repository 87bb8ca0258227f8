"""Events that services and clients publish about their calls, as in the official introspection demo."""

from typing import Any

import pytest
import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.client import Client
from rclpy.node import Node
from rclpy.qos import qos_profile_system_default
from rclpy.service import Service
from rclpy.service_introspection import ServiceIntrospectionState
from service_msgs.msg import ServiceEventInfo

from course_lib.recording import record
from course_lib.ros.graph.graph import START_NS, Graph
from course_lib.ros.messages.definitions import type_hash

KINDS = [
    ServiceEventInfo.REQUEST_SENT,
    ServiceEventInfo.REQUEST_RECEIVED,
    ServiceEventInfo.RESPONSE_SENT,
    ServiceEventInfo.RESPONSE_RECEIVED,
]
TOPIC = "/add/_service_event"
Ends = tuple[Service, Client]


def add(request: Any, response: Any) -> Any:
    response.sum = request.a + request.b
    return response


@pytest.fixture
def ends(node: Node) -> Ends:
    """A service and a client of it in one node."""
    return node.create_service(AddTwoInts, "add", add), node.create_client(AddTwoInts, "add")


def called(node: Node, ends: Ends, state: ServiceIntrospectionState) -> list[Any]:
    """Call the service once. Return the received events."""
    kind: Any = AddTwoInts
    messages: list[Any] = []
    node.create_subscription(kind.Event, "add/_service_event", messages.append, 10)
    for end in ends:
        end.configure_introspection(node.get_clock(), qos_profile_system_default, state)
    future = ends[1].call_async(AddTwoInts.Request(a=2, b=3))
    rclpy.spin_until_future_complete(node, future)
    for _ in KINDS:
        rclpy.spin_once(node, timeout_sec=0.1)
    return messages


def test_each_step_of_a_call_is_an_event_with_a_sequence_number_and_time(node: Node, ends: Ends) -> None:
    heard = called(node, ends, ServiceIntrospectionState.METADATA)
    assert [event.info.event_type for event in heard] == KINDS
    assert {event.info.sequence_number for event in heard} == {1}
    sent, taken, answered, received = (tuple(event.info.client_gid) for event in heard)
    assert (sent, taken) == (received, answered)
    assert sent != taken
    stamps = [event.info.stamp.sec * 10**9 + event.info.stamp.nanosec - START_NS for event in heard]
    assert stamps == [0, 1_000_000, 1_000_000, 2_000_000]
    assert [(len(event.request), len(event.response)) for event in heard] == [(0, 0)] * 4


def test_contents_are_included_on_request(node: Node, ends: Ends) -> None:
    heard = called(node, ends, ServiceIntrospectionState.CONTENTS)
    asked = AddTwoInts.Request(a=2, b=3)
    assert [list(event.request) for event in heard] == [[asked], [asked], [], []]
    assert [[one.sum for one in event.response] for event in heard] == [[], [], [5], [5]]


def test_disabled_or_destroyed_introspection_publishes_no_events(
    node: Node, ends: Ends, started_graph: Graph
) -> None:
    assert called(node, ends, ServiceIntrospectionState.OFF) == []
    for end in ends:
        end.configure_introspection(
            node.get_clock(), qos_profile_system_default, ServiceIntrospectionState.METADATA
        )
    assert node.count_publishers(TOPIC) == 2
    ends[1].configure_introspection(
        node.get_clock(), qos_profile_system_default, ServiceIntrospectionState.OFF
    )
    node.destroy_service(ends[0])
    assert node.count_publishers(TOPIC) == 0


def test_service_events_are_recorded_and_hashed_as_in_rosidl(
    node: Node, ends: Ends, started_graph: Graph
) -> None:
    with record(started_graph) as recorder:
        called(node, ends, ServiceIntrospectionState.CONTENTS)
    samples = [sample for sample in recorder.recording().samples if sample.topic == TOPIC]
    assert {sample.type_name for sample in samples} == {"example_interfaces/srv/AddTwoInts_Event"}
    assert type_hash(samples[0].type_name).startswith("RIHS01_")


def test_only_service_types_have_event_types() -> None:
    kind: Any = AddTwoInts
    assert kind.Event.__name__ == "AddTwoInts_Event"
    with pytest.raises(AttributeError, match="has no attribute 'Events'"):
        kind.Events  # noqa: B018
