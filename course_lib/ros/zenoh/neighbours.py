"""The nodes and endpoints of others, listed in the graph as the kit's own."""

from collections import Counter
from collections.abc import Callable

from course_lib.ros.graph import Graph
from course_lib.ros.qos import Qos
from course_lib.ros.topics import SERVICE_TOPICS, EndpointInfo, Publisher, Sample, Topics
from course_lib.ros.zenoh.tokens import Entity

MAX_KEPT = 100  # publishers that are away


class Neighbours:
    """The entities of other sessions in the graph.

    Args:
        graph: Where they are listed; the methods of the plain Graph do not announce them again.
        topics: The graph's.
        told: Called with each entity that comes.
    """

    def __init__(self, graph: Graph, topics: Topics, told: Callable[[Entity], None]) -> None:
        self._graph, self._topics, self._told = graph, topics, told
        self.servers = Counter[str]()  # service servers by name
        self._nodes: dict[tuple[str, int], int] = {}
        self._endpoints: dict[str, int] = {}  # by token
        self._publishers: dict[bytes, int] = {}  # by GID
        self._kept: dict[bytes, list[Sample]] = {}  # of publishers that are away, maybe with the link

    def __len__(self) -> int:
        return len(self._nodes)

    def ids(self) -> set[int]:
        """Return the ids of their endpoints in the graph."""
        return set(self._endpoints.values())

    def change(self, entity: Entity, there: bool) -> None:
        """Add or remove an entity; tokens come in any order."""
        if not there:
            self._remove(entity)
        elif entity.kind == "NN":
            self._node_of(entity)
        elif entity.token not in self._endpoints:
            self._endpoints[entity.token] = self._add(entity, self._node_of(entity))
            self._told(entity)

    def publisher(self, gid: bytes) -> Publisher | None:
        """Return the publisher that sent a message, if it was seen already."""
        return self._topics.publishers.get(self._publishers.get(gid, -1))

    def published(self) -> list[EndpointInfo]:
        """List their publishers."""
        publishers = (self._topics.publishers.get(number) for number in self._publishers.values())
        return [publisher.info for publisher in publishers if publisher is not None]

    def _node_of(self, entity: Entity) -> int:
        key = entity.zid, entity.node_id
        if key not in self._nodes:
            self._nodes[key] = Graph.add_node(self._graph, entity.node, entity.namespace)
        return self._nodes[key]

    def _add(self, entity: Entity, node: int) -> int:
        if entity.kind == "MP":
            endpoint = Graph.add_publisher(self._graph, node, entity.topic, entity.type_name, entity.qos)
            self._publishers[entity.gid] = endpoint
            self._topics.publishers[endpoint].kept.extend(self._kept.pop(entity.gid, ()))
            return endpoint
        topic, type_name, qos = entity.topic, entity.type_name, entity.qos
        if entity.kind in ("SS", "SC"):
            prefix, suffix = SERVICE_TOPICS[0]
            topic, type_name, qos = f"{prefix}{topic}{suffix}", f"{type_name}_{suffix}", Qos()
        if entity.kind == "SC":
            return Graph.add_publisher(self._graph, node, topic, type_name, qos)
        self.servers[entity.topic] += entity.kind == "SS"
        return Graph.add_subscription(self._graph, node, 0, topic, type_name, qos, _ignore)

    def _remove(self, entity: Entity) -> None:
        if entity.kind == "NN":
            node = self._nodes.pop((entity.zid, entity.node_id), None)
            for gid in tuple(self._publishers):
                self._put_aside(gid, node)
            if node is not None:
                Graph.remove_node(self._graph, node)
        elif (endpoint := self._endpoints.pop(entity.token, None)) is not None:
            self.servers[entity.topic] -= entity.kind == "SS"
            if entity.kind == "MP":
                self._put_aside(entity.gid, None)
                self._publishers.pop(entity.gid, None)
            Graph.remove_endpoint(self._graph, endpoint)

    def _put_aside(self, gid: bytes, of_node: int | None) -> None:
        """Keep what a publisher that goes has kept: if only the link is down, it comes back as it was."""
        publisher = self.publisher(gid)
        if publisher is not None and publisher.kept and of_node in (None, publisher.info.node):
            self._kept[gid] = list(publisher.kept)
        while len(self._kept) > MAX_KEPT:
            del self._kept[next(iter(self._kept))]


def _ignore(cdr: bytes, source_ns: int, received_ns: int) -> None:
    """Do nothing: the message goes over the network."""
