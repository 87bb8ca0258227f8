"""Which actions there are."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal

from course_lib.ros.topics import EndpointInfo
from rclpy.impl.node_graph import NamesAndTypes, sorted_types

if TYPE_CHECKING:
    from rclpy.node import Node

_TOPIC, _TYPE = "/_action/feedback", "_FeedbackMessage"  # each action has such a topic


def get_action_names_and_types(node: "Node") -> NamesAndTypes:
    """List all actions with their types."""
    return actions(node.handle.graph.endpoints())


def get_action_server_names_and_types_by_node(
    node: "Node", remote_node_name: str, remote_node_namespace: str
) -> NamesAndTypes:
    """List the actions that a node serves."""
    return _by_node(node, remote_node_name, remote_node_namespace, "pub")


def get_action_client_names_and_types_by_node(
    node: "Node", remote_node_name: str, remote_node_namespace: str
) -> NamesAndTypes:
    """List the actions that a node uses."""
    return _by_node(node, remote_node_name, remote_node_namespace, "sub")


def _by_node(node: "Node", name: str, namespace: str, kind: Literal["pub", "sub"]) -> NamesAndTypes:
    graph = node.handle.graph
    ids = {one.id for one in graph.nodes() if (one.name, one.namespace) == (name, namespace)}
    return actions(info for info in graph.endpoints() if info.node in ids and info.kind == kind)


def actions(endpoints: Iterable[EndpointInfo]) -> NamesAndTypes:
    """List the actions that endpoints serve or use."""
    return sorted_types(
        (info.topic.removesuffix(_TOPIC), info.type_name.removesuffix(_TYPE))
        for info in endpoints
        if info.topic.endswith(_TOPIC) and info.type_name.endswith(_TYPE)
    )
