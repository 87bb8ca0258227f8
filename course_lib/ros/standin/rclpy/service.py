"""Services, which respond to requests, and the base class that they share with clients."""

from collections import deque
from collections.abc import Callable
from functools import partial
from types import FunctionType
from typing import Any, Literal

from service_msgs.msg import ServiceEventInfo

from course_lib.ros.graph.graph import Graph
from course_lib.ros.graph.topics import SERVICE_HEADER, service_topics
from course_lib.ros.messages import RosMessage, deserialize, serialize, type_name
from course_lib.ros.mistakes import Mistake, mark, marked
from rclpy.callback_groups import CallbackGroup
from rclpy.clock import Clock
from rclpy.impl.endpoint import Endpoint, claim_service
from rclpy.impl.graph_queries import to_qos
from rclpy.impl.implementation_singleton import RCLError
from rclpy.impl.node_handle import Entity, NodeHandle
from rclpy.qos import QoSProfile
from rclpy.service_introspection import ServiceEvents, ServiceIntrospectionState
from rclpy.task import await_or_execute

_ASKING = (ServiceEventInfo.REQUEST_SENT, ServiceEventInfo.RESPONSE_RECEIVED)
_ANSWERING = (ServiceEventInfo.RESPONSE_SENT, ServiceEventInfo.REQUEST_RECEIVED)


class ServiceEnd(Entity):
    """A service or, if it `asks`, a client. `qos_profile` applies to both of its topics."""

    def __init_subclass__(cls) -> None:
        """Give the subclass a method of its own: Python's errors about arguments show its name."""
        inherited = ServiceEnd.configure_introspection
        own = FunctionType(inherited.__code__, inherited.__globals__, inherited.__name__)
        own.__qualname__, own.__doc__ = f"{cls.__name__}.{own.__name__}", inherited.__doc__
        cls.configure_introspection = own  # type: ignore[method-assign]

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
        self._course_full_name = full_name
        graph: Graph = node.graph
        request_type = type_name(srv_type.Request)
        requests, replies = service_topics(full_name, request_type.removesuffix("_Request"))
        kind: Literal["client", "service"] = "client" if asks else "service"
        claim_service(node, kind, full_name, request_type)
        sent, received = (requests, replies) if asks else (replies, requests)
        try:
            offered_qos = to_qos(qos_profile, "pub")
            requested_qos = to_qos(qos_profile, "sub", [offered_qos])
        except RCLError:
            raise RCLError(f"failed to create {kind}: create_{kind}() failed setting topic QoS") from None
        self._course_id = graph.add_publisher(node.id, *sent, offered_qos)
        received_id = graph.add_subscription(
            node.id, self._course_entity, *received, requested_qos, self.__receive
        )
        self.__ends = (
            Endpoint(node, self._course_id, sent[0]),
            Endpoint(node, received_id, received[0]),
        )
        self.__ends[0].registered_name = f"rq{full_name}"
        self._course_queue: deque[tuple[int, int, bytes]] = deque()
        self.__events: ServiceEvents | None = None
        self.__asks = asks
        self.__sent, self.__taken = _ASKING if asks else _ANSWERING
        self.__received_type = srv_type.Response if asks else srv_type.Request

    def configure_introspection(
        self,
        clock: Clock,
        service_event_qos_profile: QoSProfile,
        introspection_state: ServiceIntrospectionState,
    ) -> None:
        """Start or stop publishing the requests and responses on `<service>/_service_event`.

        Args:
            clock: The clock for the time stamps of the events.
            service_event_qos_profile: The QoS of the publisher.
            introspection_state: Whether events are published, and whether they contain the
                messages.
        """
        self.__ends[0].require()
        # In the order of rclpy, which calls rcl with the C objects of its arguments.
        _ = clock.handle, to_qos(service_event_qos_profile, "pub")
        if not isinstance(clock, Clock):
            raise TypeError(
                "configure_introspection(): incompatible function arguments. The clock must be a "
                f"Clock, such as node.get_clock(), not {clock!r}."
            )
        if not isinstance(introspection_state, ServiceIntrospectionState):
            raise TypeError(
                "configure_introspection(): incompatible function arguments. The state must be a "
                f"ServiceIntrospectionState, not {introspection_state!r}."
            )
        if self.__events is not None:
            self.__events.close()
        self.__events = None
        if introspection_state is not ServiceIntrospectionState.OFF:
            if not self._course_node.context.is_valid:
                kind = "client" if self.__asks else "service"
                raise RCLError(f"failed to configure {kind} introspection: rcl node's context is invalid")
            self.__events = ServiceEvents(
                self._course_node,
                self.srv_type,
                self._course_full_name,
                clock,
                service_event_qos_profile,
                introspection_state,
            )

    def _course_record_taken(self, client: int, number: int, cdr: bytes) -> None:
        """Publish the event of a received message, if introspection is enabled."""
        if self.__events is not None:
            self.__events.publish(self.__taken, client, number, deserialize(cdr, self.__received_type))

    @property
    def logger_name(self) -> str:
        """The name of the node's logger."""
        self.__ends[0].require()
        return self._course_node.logger_name

    @property
    def service_name(self) -> str:
        """The fully qualified name."""
        self.__ends[0].require()
        return self._course_full_name

    def destroy(self) -> None:
        """Leave the graph. Call the node's `destroy_service` or `destroy_client` instead."""
        for end in self.__ends:
            end.destroy()
        if self.__events is not None:
            self.__events.close()
        self._course_queue.clear()

    def _course_partner_count(self) -> int:
        """Return the number of matched subscriptions on the other side."""
        return len(self.__ends[0].require().partners())

    def _course_send(self, header: tuple[int, int], message: RosMessage) -> None:
        """Send a request, as a client, or a response, as a service.

        The header contains the client's number and that of the request.
        """
        self.__ends[0].require()
        client, number = header
        # In ROS, the middleware accepts the response, but does not deliver it.
        if not self._course_node.context.is_valid:
            return
        self._course_node.graph.publish(
            self._course_id, SERVICE_HEADER.pack(client, number) + serialize(message)
        )
        if self.__events is not None:
            self.__events.publish(self.__sent, client, number, message)

    def __receive(self, data: bytes, source_ns: int, received_ns: int) -> None:
        client, number = SERVICE_HEADER.unpack_from(data)
        # A service accepts all requests, and a client only the responses to its own requests.
        if not self.__asks or client == self._course_id:
            self._course_queue.append((client, number, data[SERVICE_HEADER.size :]))
            self._course_node.mark_ready(self)


class Service(ServiceEnd):
    """A service, created by `Node.create_service`."""

    def __init__(self, callback: Callable[[Any, Any], Any], *args: Any) -> None:
        self.callback = callback
        super().__init__(*args, asks=False)

    def send_response(self, response: Any, header: Any) -> None:
        """Send the response to a request. `header` identifies the request."""
        if not isinstance(response, self.srv_type.Response):
            raise TypeError
        self._course_send(header, response)

    def _course_take(self) -> Callable[[], object] | None:
        """Remove the oldest request and return the call that responds to it."""
        if not self._course_queue:
            return None
        client, number, cdr = self._course_queue.popleft()
        self._course_record_taken(client, number, cdr)
        return partial(self._course_answer, client, number, deserialize(cdr, self.srv_type.Request))

    async def _course_answer(self, client: int, number: int, request: Any) -> None:
        """Call the callback, which may be a coroutine, and send its response.

        Raise TypeError for another result.
        """
        try:
            response = await await_or_execute(self.callback, request, self.srv_type.Response())
        except TypeError as error:
            mark(error, Mistake.SERVICE_CALLBACK, depth=2)
            raise
        if not isinstance(response, self.srv_type.Response):
            raise marked(TypeError(), Mistake.RESPONSE)
        self._course_send((client, number), response)


class LateService(Service):
    """A service whose callback `callback(request, respond)` may respond at any later time."""

    async def _course_answer(self, client: int, number: int, request: Any) -> None:
        await await_or_execute(self.callback, request, partial(self._course_send, (client, number)))
