"""Which actions there are."""

from collections.abc import Iterable
from typing import TYPE_CHECKING

from course_lib.ros.topics import EndpointInfo
from rclpy.impl.node_graph import NamesAndTypes, sorted_types

if TYPE_CHECKING:
    from rclpy.node import Node

_TOPIC, _TYPE = "/_action/feedback", "_FeedbackMessage"  # each action has such a topic


def get_action_names_and_types(node: "Node") -> NamesAndTypes:
    """List all actions with their types."""
    return actions(node.handle.graph.endpoints())


def actions(endpoints: Iterable[EndpointInfo]) -> NamesAndTypes:
    """List the actions that endpoints serve or use."""
    return sorted_types(
        (info.topic.removesuffix(_TOPIC), info.type_name.removesuffix(_TYPE))
        for info in endpoints
        if info.topic.endswith(_TOPIC) and info.type_name.endswith(_TYPE)
    )
