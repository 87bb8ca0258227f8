"""Service introspection: requests and responses on the topic `<service>/_service_event`."""

from enum import Enum, IntEnum
from typing import Any

from service_msgs.msg import ServiceEventInfo

from course_lib.ros.messages import RosMessage, serialize, type_name
from rclpy.clock import Clock
from rclpy.impl.graph_queries import to_qos
from rclpy.impl.node_handle import NodeHandle
from rclpy.qos import QoSProfile
from rclpy.time import Time


class ServiceIntrospectionState(IntEnum):
    """The content of service events: no events, or events without or with messages."""

    OFF = 0
    METADATA = 1
    CONTENTS = 2

    __str__ = Enum.__str__


class ServiceEvents:
    """Publisher of the events of a service or client."""

    def __init__(
        self,
        node: NodeHandle,
        srv_type: Any,
        full_name: str,
        clock: Clock,
        qos_profile: QoSProfile,
        state: ServiceIntrospectionState,
    ) -> None:
        self._graph, self._kind, self._clock, self._state = node.graph, srv_type.Event, clock, state
        qos = to_qos(qos_profile, "pub")
        self._id = node.graph.add_publisher(
            node.id, f"{full_name}/_service_event", type_name(self._kind), qos
        )

    def publish(self, event_type: int, client: int, number: int, message: RosMessage) -> None:
        """Publish the event of a request or response that was sent or received."""
        # With Fast DDS, a client's own events have the GID of its writer of requests, and those of
        # a service the GID of the client's reader of responses.
        is_at_client = event_type in (ServiceEventInfo.REQUEST_SENT, ServiceEventInfo.RESPONSE_RECEIVED)
        # 3 and 4 are the kinds of writers and readers in DDS.
        entity = client << 8 | (3 if is_at_client else 4)
        info = ServiceEventInfo(
            event_type=event_type,
            stamp=Time(nanoseconds=self._clock.handle.now_ns).to_msg(),
            client_gid=list(entity.to_bytes(16, "big")),
            sequence_number=number,
        )
        event = self._kind(info=info)
        if self._state is ServiceIntrospectionState.CONTENTS:
            is_request = event_type in (ServiceEventInfo.REQUEST_SENT, ServiceEventInfo.REQUEST_RECEIVED)
            setattr(event, "request" if is_request else "response", [message])
        self._graph.publish(self._id, serialize(event))

    def close(self) -> None:
        """Remove the publisher from the graph."""
        self._graph.remove_endpoint(self._id)
