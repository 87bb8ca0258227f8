"""The server of a graph for a student's process, which cannot reach the graph itself."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self

from course_lib.ros.channel import Channel, ChannelError
from course_lib.ros.clock import Alarm
from course_lib.ros.graph import Graph
from course_lib.ros.qos import Qos
from course_lib.ros.topics import EndpointInfo

MAX_NAME = 255  # characters of a topic, type or node: every sample of a recording has them
MAX_WORD = 20  # characters of a policy, "manual_by_topic"
MAX_ENTITIES = 10_000  # nodes, endpoints and events to come
MAX_DELIVERIES = 100_000  # messages under way
MESSAGES_AT_ONCE, MESSAGES_A_SECOND = 2000, 500  # of robot time
PICTURES_A_SECOND = 64 * 2**20  # [B]
PICTURES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/PointCloud2")


class RecordingLimitError(ChannelError):
    """The student's process published, or asked for, more than a recording may hold."""


@dataclass
class Room:
    """The messages and bytes that may still be published in one run.

    Args:
        messages: Of any type.
        pictures: Bytes of pictures and point clouds.
        others: Bytes of all other messages.
    """

    messages: int = 10_000
    pictures: int = 256 * 2**20
    others: int = 4 * 2**20

    @classmethod
    def lasting(cls, seconds: float) -> Self:
        """Return the room of a run of so much robot time, [s]: more than any right program takes."""
        return cls(round(MESSAGES_AT_ONCE + MESSAGES_A_SECOND * seconds), round(PICTURES_A_SECOND * seconds))

    def take(self, type_name: str, size: int) -> None:
        """Subtract a message.

        Raises:
            RecordingLimitError: There is no more room; the message says of what.
        """
        self.messages -= 1
        if type_name in PICTURES:
            self.pictures -= size
        else:
            self.others -= size
        if min(self.messages, self.pictures, self.others) < 0:
            what = "messages" if self.messages < 0 else "pictures" if self.pictures < 0 else "bytes"
            raise RecordingLimitError(
                f"more {what} were published than are recorded, so it was stopped there: "
                "is the period of a timer too short, or does a callback publish to its own topic?"
            )


class GraphServer:
    """The server of one process over its channel; every frame from there is checked as hostile input."""

    def __init__(self, graph: Graph, channel: Channel, room: Room | None = None) -> None:
        self.graph = graph
        self.last_frame: list[Any] | None = None  # the frame that ended the serving: not one of the graph's
        self.nodes: set[int] = set()  # of that process
        self._channel = channel
        self._endpoints: dict[int, str] = {}  # the type of what they publish
        self._alarms: dict[int, Alarm] = {}
        self._room = room or Room()
        self._handlers: dict[str, tuple[tuple[type, ...], Callable[..., Any]]] = {
            "node": ((int, str, str), self._node),
            "unnode": ((int,), self._unnode),
            "pub": ((int, int, str, str, list), self._pub),
            "sub": ((int, int, int, str, str, list), self._sub),
            "unend": ((int,), self._unend),
            "publish": ((int, bytes), self._publish),
            "alarm": ((int, int, int, int), self._alarm),
            "cancel": ((int,), self._cancel),
            "nodes": ((), lambda: [(node.id, node.name, node.namespace) for node in graph.nodes()]),
            "endpoints": ((), lambda: [_row(endpoint) for endpoint in graph.endpoints()]),
            "endpoints_on": ((str,), lambda topic: [_row(end) for end in graph.endpoints_on(topic)]),
        }

    def serve(self) -> None:
        """Do what the process asks until it is idle, or sends a frame that is not the graph's.

        Raises:
            ChannelError: If a frame is not well formed; nothing of it has been done.
        """
        while self.last_frame is None:
            name, *arguments = frame = self._channel.receive()
            if name == "idle":
                return
            if name not in self._handlers:
                self.last_frame = frame
                return
            kinds, handler = self._handlers[name]
            if len(arguments) != len(kinds) or any(
                type(a) is not kind for a, kind in zip(arguments, kinds, strict=True)
            ):
                raise ChannelError(f"A frame {name!r} came with the wrong arguments.")
            answer = handler(*arguments)
            if answer is not None:
                self._channel.send(["answer", answer])

    def end(self) -> None:
        """End the run and serve the process until it sends its last frame."""
        while self.last_frame is None:
            self._channel.send(["end", self.graph.now_ns])
            self.serve()

    def _node(self, node: int, name: str, namespace: str) -> None:
        self._check(node == self.graph.last_id + 1, "node", node)
        self._count_entity(name, namespace)
        self.nodes.add(self.graph.add_node(name, namespace))

    def _unnode(self, node: int) -> None:
        self._check(node in self.nodes, "node", node)
        self.nodes.remove(node)
        self.graph.remove_node(node)

    def _pub(self, endpoint: int, node: int, topic: str, type_name: str, qos: list[Any]) -> None:
        self._check_new(endpoint, node, topic, type_name)
        self.graph.add_publisher(node, topic, type_name, _qos(qos))
        self._endpoints[endpoint] = type_name

    def _sub(self, endpoint: int, node: int, entity: int, topic: str, type_name: str, qos: list[Any]) -> None:
        self._check_new(endpoint, node, topic, type_name)

        def on_message(cdr: bytes, source_ns: int, received_ns: int) -> None:
            self._wake(["message", received_ns, endpoint, cdr, source_ns])

        self.graph.add_subscription(node, entity, topic, type_name, _qos(qos), on_message)
        self._endpoints[endpoint] = ""
        self._count_deliveries()

    def _check_new(self, endpoint: int, node: int, *names: str) -> None:
        self._check(node in self.nodes, "node", node)
        self._check(endpoint == self.graph.last_id + 1, "endpoint", endpoint)
        self._count_entity(*names)

    def _unend(self, endpoint: int) -> None:
        self._check(endpoint in self._endpoints, "endpoint", endpoint)
        del self._endpoints[endpoint]
        self.graph.remove_endpoint(endpoint)

    def _publish(self, endpoint: int, cdr: bytes) -> None:
        self._check(bool(self._endpoints.get(endpoint)), "publisher", endpoint)
        self._room.take(self._endpoints[endpoint], len(cdr))
        self.graph.publish(endpoint, cdr)
        self._count_deliveries()

    def _alarm(self, number: int, due_ns: int, node: int, entity: int) -> None:
        def fire() -> None:
            del self._alarms[number]
            self._wake(["fire", self.graph.now_ns, number])

        self._check(number not in self._alarms, "alarm", number)
        self._count_entity()
        self._count_deliveries()  # those taken back count until their time has come
        self._alarms[number] = self.graph.call_at(due_ns, fire, node=node, entity=entity)

    def _cancel(self, number: int) -> None:
        alarm = self._alarms.pop(number, None)
        self._check(alarm is not None, "alarm", number)
        if alarm is not None:
            alarm.cancel()

    def _wake(self, frame: list[Any]) -> None:
        if self.last_frame is None:
            self._channel.send(frame)
            self.serve()

    def _count_deliveries(self) -> None:
        if self.graph.pending > MAX_DELIVERIES + MAX_ENTITIES:
            raise RecordingLimitError(f"more than {MAX_DELIVERIES} messages were under way at a time")

    def _count_entity(self, *names: str) -> None:
        count = len(self.nodes) + len(self._endpoints) + len(self._alarms)
        if count >= MAX_ENTITIES or any(len(name) > MAX_NAME for name in names):
            raise RecordingLimitError(
                f"More than {MAX_ENTITIES} nodes, topics and timers were asked for, "
                f"or a name of over {MAX_NAME} characters."
            )

    @staticmethod
    def _check(known: bool, what: str, number: int) -> None:
        if not known:
            raise ChannelError(f"The process speaks of {what} {number}, which is not its own.")


def _row(info: EndpointInfo) -> tuple[Any, ...]:
    return info.id, info.kind, info.node, info.topic, info.type_name, info.qos.row()


def _qos(values: list[Any]) -> Qos:
    try:
        qos = Qos(*values)
    except TypeError as error:
        raise ChannelError(f"Not a QoS: {values!r:.200}") from error
    durations = (qos.deadline_ns, qos.lifespan_ns, qos.lease_ns)
    words = (qos.history, qos.reliability, qos.durability, qos.liveliness)
    if (
        type(qos.depth) is not int
        or not 0 <= qos.depth <= 10**6
        or not all(isinstance(word, str) and len(word) < MAX_WORD for word in words)
        or not all(d is None or type(d) is int for d in durations)
    ):
        raise ChannelError(f"Not a QoS: {values!r:.200}")
    return qos
