"""The node of a viewer in the running graph: tools publish through it, and displays call services."""

from collections.abc import Callable
from itertools import count
from typing import Any

from course_lib.displays.view_time import ViewTime
from course_lib.ros.graph import Graph
from course_lib.ros.messages import deserialize, serialize, service_class, type_name
from course_lib.ros.qos import Qos
from course_lib.ros.topics import SERVICE_HEADER, SERVICE_TOPICS

NAME = "rviz2"
_SERVICE = Qos(depth=10)
Message = Any  # of the generated classes, which are known by name only


class RvizNode:
    """A node that is in the graph from its first use."""

    def __init__(self, graph: Graph, time: ViewTime) -> None:
        self._graph = graph
        self._time = time
        self._node: int | None = None
        self._publishers: dict[tuple[str, str, Qos], int] = {}  # endpoints
        self._clients: dict[str, int] = {}  # the endpoints that send requests, by service
        self._waiting: dict[int, Callable[[Message], None]] = {}  # by the number of the request
        self._numbers = count(1)

    @property
    def now_ns(self) -> int:
        """ROS time, [ns]."""
        return self._time.ros_ns(self._graph.now_ns)

    def publish(self, topic: str, type_name: str, qos: Qos, message: Message) -> None:
        """Publish a message on a fully resolved topic."""
        self._graph.publish(self.publisher(topic, type_name, qos), serialize(message))

    def publisher(self, topic: str, type_name: str, qos: Qos) -> int:
        """Return the endpoint of a publisher, made on its first use."""
        wanted = (topic, type_name, qos)
        if wanted not in self._publishers:
            self._publishers[wanted] = self._graph.add_publisher(self._id(), *wanted)
        return self._publishers[wanted]

    def has_service(self, name: str) -> bool:
        """Return whether somebody answers a service, by its full name."""
        ends = (end for end in self._graph.endpoints() if end.is_service)
        return any(end.service is not None and end.service[0] == name for end in ends)

    def call(self, name: str, service: str, callback: Callable[[Message], None]) -> None:
        """Send an empty request; the callback is called with the response, when it comes.

        Args:
            name: Full name of the service.
            service: Its type, ``visualization_msgs/srv/GetInteractiveMarkers``.
            callback: Is called once, with the response.
        """
        kind: Any = service_class(service)
        if name not in self._clients:
            self._clients[name] = self._client(name, kind)
        client, number = self._clients[name], next(self._numbers)
        self._waiting[number] = callback
        self._graph.publish(client, SERVICE_HEADER.pack(client, number) + serialize(kind.Request()))

    def close(self) -> None:
        """Leave the graph."""
        if self._node is not None:
            self._graph.remove_node(self._node)
        self._node = None
        for ends in (self._publishers, self._clients, self._waiting):
            ends.clear()

    def _id(self) -> int:
        if self._node is None:
            self._node = self._graph.add_node(NAME, "/")
        return self._node

    def _client(self, name: str, kind: Any) -> int:
        """Add the two endpoints of a client; returns the one that sends requests."""
        (asked, answered) = (f"{prefix}{name}{suffix}" for prefix, suffix in SERVICE_TOPICS)
        client = self._graph.add_publisher(self._id(), asked, type_name(kind.Request), _SERVICE)

        def take(data: bytes, source_ns: int, received_ns: int) -> None:
            addressee, number = SERVICE_HEADER.unpack_from(data)
            if addressee == client and number in self._waiting:
                response = deserialize(data[SERVICE_HEADER.size :], kind.Response)
                self._waiting.pop(number)(response)

        self._graph.add_subscription(self._id(), 0, answered, type_name(kind.Response), _SERVICE, take)
        return client
