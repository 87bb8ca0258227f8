"""What a node can find out about the graph."""

from collections.abc import Iterable
from typing import Literal

from course_lib.ros.topics import EndpointInfo
from rclpy.impl import names
from rclpy.impl.node_handle import NodeHandle
from rclpy.impl.qos_conversion import to_profile
from rclpy.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum

NamesAndTypes = list[tuple[str, list[str]]]


class NodeGraph:
    """The part of Node that asks the graph."""

    def __init__(self, handle: NodeHandle) -> None:
        self._Node__handle = handle

    @property
    def handle(self) -> NodeHandle:
        """The node as the graph knows it."""
        return self._Node__handle

    def get_node_names(self) -> list[str]:
        """List the names of all nodes."""
        return [name for name, _ in self.get_node_names_and_namespaces()]

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """List (name, namespace) of all nodes."""
        return [(node.name, node.namespace) for node in self.handle.graph.nodes()]

    def get_topic_names_and_types(self, no_demangle: bool = False) -> NamesAndTypes:
        """List all topics with their types."""
        infos = self.handle.graph.endpoints()
        return sorted_types((info.topic, info.type_name) for info in infos if info.service is None)

    def get_service_names_and_types(self) -> NamesAndTypes:
        """List all services with their types; as in ROS also those that are only asked for."""
        return services(self.handle.graph.endpoints())

    def count_publishers(self, topic_name: str) -> int:
        """Count the publishers on a topic."""
        return len(self._on_topic(topic_name, "pub"))

    def count_subscribers(self, topic_name: str) -> int:
        """Count the subscriptions on a topic."""
        return len(self._on_topic(topic_name, "sub"))

    def get_publishers_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """List the publishers on a topic, with their quality of service."""
        return [self._describe(info) for info in self._on_topic(topic_name, "pub")]

    def get_subscriptions_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """List the subscriptions on a topic, with their quality of service."""
        return [self._describe(info) for info in self._on_topic(topic_name, "sub")]

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return the full name that a topic has for this node."""
        return self._resolve(topic, "topic", only_expand)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """Return the full name that a service has for this node."""
        return self._resolve(service, "service", only_expand)

    def _resolve(self, name: str, kind: names.Kind, only_expand: bool) -> str:
        node = self.handle
        full = names.expand_name(name, node.name, node.namespace, kind)
        return full if only_expand else node.arguments.remapped(full, node.name, node.namespace, kind)

    def _on_topic(self, topic_name: str, kind: Literal["pub", "sub"]) -> list[EndpointInfo]:
        topic = self.resolve_topic_name(topic_name)
        return [info for info in self.handle.graph.endpoints() if info.topic == topic and info.kind == kind]

    def _describe(self, info: EndpointInfo) -> TopicEndpointInfo:
        node = next(node for node in self.handle.graph.nodes() if node.id == info.node)
        kind = TopicEndpointTypeEnum.PUBLISHER if info.kind == "pub" else TopicEndpointTypeEnum.SUBSCRIPTION
        return TopicEndpointInfo(
            node_name=node.name,
            node_namespace=node.namespace,
            topic_type=info.type_name,
            endpoint_type=kind,
            endpoint_gid=list(info.id.to_bytes(16, "big")),
            qos_profile=to_profile(info.qos),
        )


def services(endpoints: Iterable[EndpointInfo]) -> NamesAndTypes:
    """List the services that endpoints answer or ask."""
    return sorted_types(info.service for info in endpoints if info.service is not None)


def sorted_types(pairs: Iterable[tuple[str, str]]) -> NamesAndTypes:
    """Sort (name, type) pairs: each name once, with all its types."""
    types: dict[str, set[str]] = {}
    for name, type_name in pairs:
        types.setdefault(name, set()).add(type_name)
    return [(name, sorted(types[name])) for name in sorted(types)]
