"""What is known about a publisher or a subscription on a topic."""

from dataclasses import dataclass
from enum import IntEnum

from rclpy.qos import HistoryPolicy, QoSProfile


class TopicEndpointTypeEnum(IntEnum):
    """The kinds of endpoint."""

    INVALID = 0
    PUBLISHER = 1
    SUBSCRIPTION = 2


@dataclass
class TopicEndpointInfo:
    """A publisher or a subscription on a topic; `str` of it is what `ros2 topic info -v` shows."""

    node_name: str
    node_namespace: str
    topic_type: str
    endpoint_type: TopicEndpointTypeEnum
    endpoint_gid: list[int]
    qos_profile: QoSProfile

    def __str__(self) -> str:
        qos = self.qos_profile
        depth = f" ({qos.depth})" if qos.history == HistoryPolicy.KEEP_LAST else ""
        lines = {
            "Node name": self.node_name,
            "Node namespace": self.node_namespace,
            "Topic type": self.topic_type,
            "Endpoint type": self.endpoint_type.name,
            "GID": ".".join(f"{byte:02x}" for byte in self.endpoint_gid),
            "QoS profile": "",
            "  Reliability": qos.reliability.name,
            "  History (Depth)": f"{qos.history.name}{depth}",
            "  Durability": qos.durability.name,
            "  Lifespan": qos.lifespan,
            "  Deadline": qos.deadline,
            "  Liveliness": qos.liveliness.name,
            "  Liveliness lease duration": qos.liveliness_lease_duration,
        }
        return "\n".join(f"{name}: {value}".rstrip() for name, value in lines.items())
