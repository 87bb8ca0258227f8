"""The part of Node that resolves names and queries the graph."""

import time
from typing import Literal

from course_lib.ros.graph import EndpointInfo, NodeInfo
from rclpy.exceptions import NodeNameNonExistentError
from rclpy.impl import names
from rclpy.impl.graph_queries import NamesAndTypes, TopicEndpointInfo, describe, services, sorted_types
from rclpy.impl.node_handle import NodeHandle

_LOOK = 0.1  # [s] between two looks for a node, as in rclpy
_ENCLAVE = "/"  # of every node: nothing is secured here


class Node:
    """The part of Node that queries the graph; it has the name Node for the sake of Python's errors."""

    def __init__(self, handle: NodeHandle) -> None:
        self.__handle = handle

    @property
    def handle(self) -> NodeHandle:
        """The node as the graph knows it."""
        return self.__handle

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
        """List all services with their types; as in ROS also those that have only clients."""
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
        return [describe(info, self.handle.graph.nodes()) for info in self._on_topic(topic_name, "pub")]

    def get_subscriptions_info_by_topic(
        self, topic_name: str, no_mangle: bool = False
    ) -> list[TopicEndpointInfo]:
        """List the subscriptions on a topic, with their quality of service."""
        return [describe(info, self.handle.graph.nodes()) for info in self._on_topic(topic_name, "sub")]

    def get_fully_qualified_node_names(self) -> list[str]:
        """List the full names of all nodes."""
        return [node.full_name for node in self.handle.graph.nodes()]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """List (name, namespace, enclave) of all nodes."""
        return [(*pair, _ENCLAVE) for pair in self.get_node_names_and_namespaces()]

    def wait_for_node(self, fully_qualified_node_name: str, timeout: float) -> bool:
        """Wait until a node is there, at most so long [s]; returns whether it is."""
        wanted, until = f"/{fully_qualified_node_name.removeprefix('/')}", time.time() + timeout
        while wanted not in self.get_fully_qualified_node_names():
            if time.time() >= until:
                return False
            time.sleep(_LOOK)
        return True

    def get_publisher_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """List the topics that a node publishes on; a NodeNameNonExistentError if there is no such node."""
        infos = self._of_node(node_name, node_namespace)
        return sorted_types((i.topic, i.type_name) for i in infos if i.service is None and i.kind == "pub")

    def get_subscriber_names_and_types_by_node(
        self, node_name: str, node_namespace: str, no_demangle: bool = False
    ) -> NamesAndTypes:
        """List the topics that a node subscribes to."""
        infos = self._of_node(node_name, node_namespace)
        return sorted_types((i.topic, i.type_name) for i in infos if i.service is None and i.kind == "sub")

    def get_service_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """List the services of a node."""
        return services(i for i in self._of_node(node_name, node_namespace) if i.is_service)

    def get_client_names_and_types_by_node(self, node_name: str, node_namespace: str) -> NamesAndTypes:
        """List the services that a node calls."""
        return services(i for i in self._of_node(node_name, node_namespace) if i.is_client)

    def count_services(self, service_name: str) -> int:
        """Count the servers of a service."""
        name = self.resolve_service_name(service_name)
        infos = self.handle.graph.endpoints()
        return sum(i.is_service and i.service is not None and i.service[0] == name for i in infos)

    def count_clients(self, service_name: str) -> int:
        """Count the clients of a service."""
        name = self.resolve_service_name(service_name)
        infos = self.handle.graph.endpoints()
        return sum(i.is_client and i.service is not None and i.service[0] == name for i in infos)

    def _of_node(self, name: str, namespace: str) -> list[EndpointInfo]:
        def is_meant(node: NodeInfo) -> bool:
            return (node.name, node.namespace) == (name, namespace)

        graph = self.handle.graph
        found = [node.id for node in graph.nodes() if is_meant(node)]
        if not found:
            raise NodeNameNonExistentError(
                f"cannot get publisher names and types for nonexistent node: {names.join(namespace, name)}"
            )
        return [info for info in graph.endpoints() if info.node == found[0]]

    def resolve_topic_name(self, topic: str, *, only_expand: bool = False) -> str:
        """Return the full name that a topic has for this node."""
        return self._resolve(topic, "topic", only_expand)

    def resolve_service_name(self, service: str, *, only_expand: bool = False) -> str:
        """Return the full name that a service has for this node."""
        return self._resolve(service, "service", only_expand)

    def _resolve(self, name: str, kind: names.Kind, only_expand: bool) -> str:
        node = self.handle
        if not isinstance(name, str):
            raise TypeError("rclpy_resolve_name(): incompatible function arguments.")
        full = names.expand_name(name, node.name, node.namespace, kind)
        return full if only_expand else node.arguments.remapped(full, node.name, node.namespace, kind)

    def _on_topic(self, topic_name: str, kind: Literal["pub", "sub"]) -> list[EndpointInfo]:
        ends = self.handle.graph.endpoints_on(self.resolve_topic_name(topic_name))
        return [info for info in ends if info.kind == kind]
