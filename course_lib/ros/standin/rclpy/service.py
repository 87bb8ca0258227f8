"""Services, which answer requests, and the half of them that clients share."""

from collections import deque
from collections.abc import Callable
from functools import partial
from typing import Any

from service_msgs.msg import ServiceEventInfo

from course_lib.ros.graph import Graph
from course_lib.ros.messages import RosMessage, deserialize, serialize, type_name
from course_lib.ros.mistakes import Mistake, mark, marked
from course_lib.ros.topics import SERVICE_HEADER, SERVICE_TOPICS
from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock
from rclpy.exceptions import RCLError
from rclpy.impl.endpoint import Endpoint
from rclpy.impl.graph_queries import to_qos
from rclpy.impl.node_handle import Entity, NodeHandle
from rclpy.qos import QoSProfile
from rclpy.service_introspection import ServiceEvents, ServiceIntrospectionState
from rclpy.task import await_or_execute

_ASKING = (ServiceEventInfo.REQUEST_SENT, ServiceEventInfo.RESPONSE_RECEIVED)
_ANSWERING = (ServiceEventInfo.RESPONSE_SENT, ServiceEventInfo.REQUEST_RECEIVED)


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
        self._events: ServiceEvents | None = None
        self._sent, self._taken = _ASKING if asks else _ANSWERING
        self._heard_type = srv_type.Response if asks else srv_type.Request

    def configure_introspection(
        self,
        clock: Clock,
        service_event_qos_profile: QoSProfile,
        introspection_state: ServiceIntrospectionState,
    ) -> None:
        """Publish what is sent and taken on `<service>/_service_event`, or no longer.

        Args:
            clock: Its time stamps the events.
            service_event_qos_profile: The publisher's quality of service.
            introspection_state: Whether events are published, and whether with the messages.
        """
        self._ends[0].require()
        if self._events is not None:
            self._events.close()
        self._events = None
        if introspection_state is not ServiceIntrospectionState.OFF:
            self._events = ServiceEvents(
                self.node_handle,
                self.srv_type,
                self.full_name,
                clock,
                service_event_qos_profile,
                introspection_state,
            )

    def note_taken(self, client: int, number: int, cdr: bytes) -> None:
        """Publish the event that a message was taken, if that is wanted."""
        if self._events is not None:
            self._events.publish(self._taken, client, number, deserialize(cdr, self._heard_type))

    @property
    def service_name(self) -> str:
        """The fully resolved name."""
        self._ends[0].require()
        return self.full_name

    def destroy(self) -> None:
        """Leave the graph; call the node's `destroy_service` or `destroy_client` instead."""
        for end in self._ends:
            end.destroy()
        if self._events is not None:
            self._events.close()
        self._queue.clear()

    def partner_count(self) -> int:
        """Count the subscriptions that its messages reach."""
        return self._ends[0].require().partner_count()

    def send(self, client: int, number: int, message: RosMessage) -> None:
        """Send a client's request, or the response to it."""
        self._ends[0].require()
        if not self.node_handle.context.is_valid:
            raise RCLError("Failed to send: the context is invalid")
        self.node_handle.graph.publish(self.id, SERVICE_HEADER.pack(client, number) + serialize(message))
        if self._events is not None:
            self._events.publish(self._sent, client, number, message)

    def is_for_me(self, client: int) -> bool:
        """Return whether a message is for this end: a service takes all requests."""
        return True

    def _receive(self, data: bytes, source_ns: int, received_ns: int) -> None:
        client, number = SERVICE_HEADER.unpack_from(data)
        if self.is_for_me(client):
            self._queue.append((client, number, data[SERVICE_HEADER.size :]))
            self.node_handle.mark_ready(self)


class Service(ServiceEnd):
    """A service; made by `Node.create_service`."""

    def __init__(self, callback: Callable[[Any, Any], Any], *args: Any) -> None:
        self.callback = callback
        super().__init__(*args, asks=False)

    def take(self) -> Callable[[], object] | None:
        """Remove the oldest request; returns the call that answers it."""
        if not self._queue:
            return None
        client, number, cdr = self._queue.popleft()
        self.note_taken(client, number, cdr)
        return partial(self._answer, client, number, deserialize(cdr, self.srv_type.Request))

    async def _answer(self, client: int, number: int, request: Any) -> None:
        """Send the response of the callback, maybe a coroutine; raises TypeError for anything else."""
        try:
            response = await await_or_execute(self.callback, request, self.srv_type.Response())
        except TypeError as error:
            mark(error, Mistake.SERVICE_CALLBACK, depth=2)
            raise
        if not isinstance(response, self.srv_type.Response):
            raise marked(TypeError(), Mistake.RESPONSE)
        self.send(client, number, response)


class LateService(Service):
    """A service with the callback `callback(request, respond)`, which may respond at any time."""

    async def _answer(self, client: int, number: int, request: Any) -> None:
        await await_or_execute(self.callback, request, partial(self.send, client, number))
