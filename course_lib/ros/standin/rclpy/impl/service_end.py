"""What a service and its clients share: one end of the two topics on which requests and responses travel."""

from collections import deque
from typing import Any

from course_lib.ros.graph import Graph
from course_lib.ros.messages import Message, serialize, type_name
from course_lib.ros.topics import SERVICE_HEADER, SERVICE_TOPICS
from rclpy.callback_groups import CallbackGroup
from rclpy.exceptions import RCLError
from rclpy.impl.endpoint import Endpoint
from rclpy.impl.node_handle import Entity, NodeHandle
from rclpy.impl.qos_conversion import to_qos
from rclpy.qos import QoSProfile


class ServiceEnd(Entity):
    """A service or, if it `asks`, a client; `qos_profile` holds for both topics."""

    def __init__(
        self,
        node: NodeHandle,
        group: CallbackGroup,
        srv_type: Any,
        srv_name: str,
        full_name: str,
        qos_profile: QoSProfile,
        *,
        asks: bool,
    ) -> None:
        super().__init__(node, group)
        self.srv_type, self.srv_name, self.qos_profile = srv_type, srv_name, qos_profile
        self.full_name = full_name
        graph: Graph = node.graph
        names = [f"{prefix}{full_name}{suffix}" for prefix, suffix in SERVICE_TOPICS]
        types = [type_name(part) for part in (srv_type.Request, srv_type.Response)]
        sent, heard = (0, 1) if asks else (1, 0)
        offered, wanted = to_qos(qos_profile, "pub"), to_qos(qos_profile, "sub")
        self.id = graph.add_publisher(node.id, names[sent], types[sent], offered)
        heard_id = graph.add_subscription(
            node.id, self.entity, names[heard], types[heard], wanted, self._receive
        )
        self._ends = (Endpoint(node, self.id, names[sent]), Endpoint(node, heard_id, names[heard]))
        self._queue: deque[tuple[int, int, bytes]] = deque()

    @property
    def service_name(self) -> str:
        """The fully resolved name."""
        self._ends[0].require()
        return self.full_name

    def destroy(self) -> None:
        """Leave the graph; call the node's `destroy_service` or `destroy_client` instead."""
        for end in self._ends:
            end.destroy()
        self._queue.clear()

    def partner_count(self) -> int:
        """Count those who hear what it sends."""
        return self._ends[0].require().partner_count()

    def send(self, client: int, number: int, message: Message) -> None:
        """Send a client's request, or the response to it."""
        self._ends[0].require()
        if not self.node_handle.context.is_valid:
            raise RCLError("Failed to send: the context is invalid")
        self.node_handle.graph.publish(self.id, SERVICE_HEADER.pack(client, number) + serialize(message))

    def is_for_me(self, client: int) -> bool:
        """Say whether what came is to be taken: a service takes all requests."""
        return True

    def _receive(self, data: bytes, source_ns: int, received_ns: int) -> None:
        client, number = SERVICE_HEADER.unpack_from(data)
        if self.is_for_me(client):
            self._queue.append((client, number, data[SERVICE_HEADER.size :]))
            self.node_handle.mark_ready(self)
