"""A graph that a student's process uses through a socket, and the server that owns its clock.

The grader judges the messages that a student's nodes publish, so the graph must not live in the
process that runs their code. There, a `RemoteGraph` sends each operation as a frame; in the grader,
a `GraphServer` applies it to the graph that is recorded. Frames are length-prefixed msgpack. The
process may run hostile code, so everything received from it is validated and limited.

Events run in lock-step. When all threads of the process wait, it sends "idle"; the server advances
the graph, sends the next event for the process ("message" or "fire", with the robot time) and
serves requests until the process is idle again. So a run repeats exactly, however fast the process
is, and its code cannot change the evidence.
"""

import socket
import struct
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self, TypeVar

import msgpack

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Alarm, Graph
from course_lib.ros.graph.topics import OWN_TOPICS, EndpointInfo, NodeInfo, OnMessage, Qos, Sample
from course_lib.ros.time import wall

# Limit on the size of a frame [bytes].
MAX_FRAME = 32 * 2**20
# Limit on the items of all lists and dicts of a frame: an empty one takes 1 byte in the frame, but
# 60 in memory.
MAX_ITEMS = 1_000_000
# Bytes to read or to queue at a time. Several small frames are read together.
READ_SIZE, MAX_BATCH = 2**14, 2**20
# Limit on queued frames, so that the other side notices an endless loop.
MAX_QUEUED = 256
# Interval after which the socket's timeout is updated from the deadline [s].
DEADLINE_REFRESH = 0.02
_HEADER = struct.Struct("!I")
T = TypeVar("T")
R = TypeVar("R")


class ChannelError(CourseError):
    """The other side violated the protocol."""


class FrameSizeError(ChannelError):
    """The other side sent a frame above the limit."""


class ChannelClosedError(ChannelError):
    """The other side has closed the connection."""


class ChannelTimeoutError(ChannelError):
    """The other side did not respond in time."""


class Channel:
    """One end of a socket pair. It takes ownership of `connection`, a connected stream socket."""

    def __init__(self, connection: socket.socket) -> None:
        self._socket = connection
        self._socket.settimeout(None)
        # End of waiting, in seconds of `time.monotonic()`.
        self.deadline: float | None = None
        # Returns how long [s] the deadline is extended when it is reached.
        self.overtime: Callable[[], float] = lambda: 0.0
        # The deadline from which the socket's timeout was computed, and the time of this
        # computation.
        self._socket_deadline: tuple[float | None, float] = (None, 0.0)
        self._unsent: list[bytes] = []
        self._unsent_bytes = 0
        # Received bytes after the last complete frame.
        self._received = bytearray()

    def queue(self, frame: list[Any]) -> None:
        """Queue a frame that needs no response.

        It is sent with the next `send`, or when the queue is full.
        """
        body = msgpack.packb(frame, use_bin_type=True)
        self._unsent.append(_HEADER.pack(len(body)) + body)
        self._unsent_bytes += len(body)
        if len(self._unsent) >= MAX_QUEUED or self._unsent_bytes >= MAX_BATCH:
            self._send_all()

    def send(self, frame: list[Any]) -> None:
        """Send a frame after the queued ones.

        Raise a ChannelError if it is not accepted in time.
        """
        self.queue(frame)
        if self._unsent:
            self._send_all()

    def receive(self) -> list[Any]:
        """Receive the next frame.

        Raise a ChannelError if none arrives in time, or if it is invalid.
        """
        (size,) = _HEADER.unpack(self._read_bytes(_HEADER.size))
        if size > MAX_FRAME:
            raise FrameSizeError(f"Received a frame of {size} bytes; the limit is {MAX_FRAME} bytes.")
        body = self._read_bytes(size)
        remaining_items = MAX_ITEMS

        def count_items(items: Any) -> Any:
            """Count the items of a list or dict while it is unpacked."""
            nonlocal remaining_items
            remaining_items -= len(items) + 1
            if remaining_items < 0:
                raise ValueError(f"more than {MAX_ITEMS} items")
            return items

        try:
            frame = msgpack.unpackb(
                body, raw=False, strict_map_key=True, list_hook=count_items, object_hook=count_items
            )
        except (ValueError, msgpack.UnpackException, RecursionError) as error:
            raise ChannelError(f"The received data is not a valid frame: {error}") from error
        if not isinstance(frame, list) or not frame or not isinstance(frame[0], str):
            raise ChannelError("The received frame is not a list that starts with its name.")
        return frame

    def close(self) -> None:
        """Close this end."""
        self._socket.close()

    def _send_all(self) -> None:
        data, self._unsent, self._unsent_bytes = b"".join(self._unsent), [], 0
        self._run(self._socket.sendall, data)

    def _read_bytes(self, size: int) -> bytes:
        """Wait for `size` bytes, remove them from the buffer and return them."""
        while len(self._received) < size:
            try:
                chunk = self._run(
                    self._socket.recv, max(READ_SIZE, min(size - len(self._received), MAX_BATCH))
                )
            except ChannelTimeoutError:
                if not self._is_in_overtime():
                    raise
                continue
            if not chunk:
                raise ChannelClosedError("The other process has ended.")
            self._received += chunk
        # A memoryview avoids a second copy of a large message: slicing a bytearray copies it, and
        # so does bytes().
        with memoryview(self._received) as buffer, buffer[:size] as first_bytes:
            data = bytes(first_bytes)
        del self._received[:size]
        return data

    def _run(self, action: Callable[[T], R], argument: T) -> R:
        """Call `action`, which sends or receives, with a timeout at the deadline.

        The socket's timeout is updated often enough to keep the deadline to 20 ms.
        """
        try:
            if self.deadline is not None or self._socket_deadline[0] is not None:
                now, (applied_deadline, since) = wall.monotonic(), self._socket_deadline
                if self.deadline is not None and self.deadline <= now and not self._is_in_overtime():
                    raise TimeoutError
                if self.deadline != applied_deadline or now - since > DEADLINE_REFRESH:
                    self._socket.settimeout(None if self.deadline is None else self.deadline - now)
                    self._socket_deadline = self.deadline, now
            return action(argument)
        except TimeoutError as error:
            raise ChannelTimeoutError("The other process did not answer in time.") from error
        except OSError as error:
            raise ChannelClosedError("The other process has ended.") from error

    def _is_in_overtime(self) -> bool:
        self.deadline = (self.deadline or 0.0) + self.overtime()
        return self.deadline > wall.monotonic()


# Limit on the characters of a topic, type or node name, which every recorded sample contains.
MAX_NAME = 255
# Limit on the characters of a QoS policy value, such as "manual_by_topic".
MAX_WORD = 20
# Limit on nodes, endpoints and scheduled events.
MAX_ENTITIES = 10_000
# Limit on messages in transit.
MAX_DELIVERIES = 100_000
# Limit on the bytes of messages in transit or kept for late-joining subscriptions, which are in
# this process's memory.
MAX_HELD = 64 * 2**20
# Messages that may be published in a burst, and per second of robot time.
MESSAGES_AT_ONCE, MESSAGES_A_SECOND = 2000, 500
# Bytes of images and point clouds per second of robot time.
IMAGE_BYTES_A_SECOND = 64 * 2**20
IMAGE_TYPES = ("sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/PointCloud2")


class RecordingLimitError(ChannelError):
    """The student's process published or requested more than a recording may contain."""


class MemoryLimitError(RecordingLimitError):
    """The student's process published more than this process may hold in memory for it."""


@dataclass
class RecordingBudget:
    """The numbers of messages and bytes that may still be published in one run.

    Args:
        messages: Messages of any type.
        image_bytes: Bytes of images and point clouds.
        other_bytes: Bytes of all other messages.
    """

    messages: int = 10_000
    image_bytes: int = 256 * 2**20
    other_bytes: int = 4 * 2**20

    @classmethod
    def for_duration(cls, seconds: float) -> Self:
        """Return the budget of a run that takes `seconds` [s] of robot time.

        Correct programs need less.
        """
        return cls(
            round(MESSAGES_AT_ONCE + MESSAGES_A_SECOND * seconds), round(IMAGE_BYTES_A_SECOND * seconds)
        )

    def charge(self, type_name: str, size: int) -> None:
        """Subtract a message from the budget.

        Raises:
            RecordingLimitError: The budget is exhausted; the message states which one.
        """
        self.messages -= 1
        if type_name in IMAGE_TYPES:
            self.image_bytes -= size
        else:
            self.other_bytes -= size
        if min(self.messages, self.image_bytes, self.other_bytes) < 0:
            exceeded = "messages" if self.messages < 0 else "pictures" if self.image_bytes < 0 else "bytes"
            raise RecordingLimitError(
                f"the limit on recorded {exceeded} was reached, so the program was stopped: "
                "is the period of a timer too short, or does a callback publish to its own topic?"
            )


@dataclass(frozen=True)
class _Request:
    """A request that a process may send: the exact types of its arguments, and its handler."""

    kinds: tuple[type, ...]
    handle: Callable[..., Any]


class GraphServer:
    """The server for one process, reached over a channel.

    It validates every frame as hostile input.
    """

    def __init__(
        self,
        graph: Graph,
        channel: Channel,
        budget: RecordingBudget | None = None,
    ) -> None:
        self.graph = graph
        # The first frame that is not a request of the graph, which ends the service.
        self.last_frame: list[Any] | None = None
        # Ids of the process's nodes.
        self.nodes: set[int] = set()
        self._channel = channel
        # The type that each endpoint publishes; "" if it cannot publish.
        self._endpoints: dict[int, str] = {}
        # Endpoint ids by node.
        self._endpoints_of: dict[int, list[int]] = {}
        # An upper bound on the bytes held, so that they need not be counted at each message.
        self._stored_bound = 0
        self._alarms: dict[int, Alarm] = {}
        self._budget = budget or RecordingBudget()
        self._requests = {
            "node": _Request((int, str, str), self._add_node),
            "unnode": _Request((int,), self._remove_node),
            "pub": _Request((int, int, str, str, list), self._add_publisher),
            "sub": _Request((int, int, int, str, str, list), self._add_subscription),
            "unend": _Request((int,), self._remove_endpoint),
            "publish": _Request((int, bytes), self._publish),
            "alarm": _Request((int, int, int, int), self._schedule_alarm),
            "cancel": _Request((int,), self._cancel_alarm),
            "nodes": _Request((), lambda: [(n.id, n.name, n.namespace) for n in graph.nodes()]),
            "endpoints": _Request((), lambda: [_endpoint_row(info) for info in graph.endpoints()]),
            "endpoints_on": _Request(
                (str,), lambda topic: [_endpoint_row(info) for info in graph.endpoints_on(topic)]
            ),
        }

    def serve(self) -> None:
        """Serve requests until the process is idle or sends a frame that is not a request.

        Raises:
            ChannelError: A frame is invalid. It has had no effect.
        """
        while self.last_frame is None:
            name, *arguments = frame = self._channel.receive()
            if name == "idle":
                return
            request = self._requests.get(name)
            if request is None:
                self.last_frame = frame
                return
            if tuple(map(type, arguments)) != request.kinds:
                raise ChannelError(f"The frame {name!r} has the wrong arguments.")
            answer = request.handle(*arguments)
            if answer is not None:
                self._channel.send(["answer", answer])

    def end(self) -> None:
        """End the run, and serve the process until it sends its last frame."""
        while self.last_frame is None:
            self._channel.send(["end", self.graph.now_ns])
            self.serve()

    def _add_node(self, node: int, name: str, namespace: str) -> None:
        self._check(node == self.graph.last_id + 1, "node", node)
        self._count_entity(name, namespace)
        self.nodes.add(self.graph.add_node(name, namespace))

    def _remove_node(self, node: int) -> None:
        self._check(node in self.nodes, "node", node)
        self.nodes.remove(node)
        self.graph.remove_node(node)
        # The process may still remove the endpoints one by one, but can no longer publish with
        # them.
        for endpoint in self._endpoints_of.pop(node, ()):
            if endpoint in self._endpoints:
                self._endpoints[endpoint] = ""

    def _add_publisher(
        self,
        endpoint: int,
        node: int,
        topic: str,
        type_name: str,
        qos: list[Any],
    ) -> None:
        self._check_new(endpoint, node, topic, type_name)
        self.graph.add_publisher(node, topic, type_name, _qos(qos))
        self._endpoints[endpoint] = type_name
        self._endpoints_of.setdefault(node, []).append(endpoint)

    def _add_subscription(
        self, endpoint: int, node: int, entity: int, topic: str, type_name: str, qos: list[Any]
    ) -> None:
        self._check_new(endpoint, node, topic, type_name)

        def on_message(cdr: bytes, source_ns: int, received_ns: int) -> None:
            has_more = self.graph.has_more
            self._send_and_serve(
                ["message", received_ns, endpoint, cdr, source_ns, has_more], serve=not has_more
            )

        self.graph.add_subscription(node, entity, topic, type_name, _qos(qos), on_message)
        self._endpoints[endpoint] = ""
        self._count_deliveries()

    def _check_new(self, endpoint: int, node: int, *names: str) -> None:
        self._check(node in self.nodes, "node", node)
        self._check(endpoint == self.graph.last_id + 1, "endpoint", endpoint)
        self._count_entity(*names)

    def _remove_endpoint(self, endpoint: int) -> None:
        self._check(endpoint in self._endpoints, "endpoint", endpoint)
        del self._endpoints[endpoint]
        self.graph.remove_endpoint(endpoint)

    def _publish(self, endpoint: int, cdr: bytes) -> None:
        self._check(bool(self._endpoints.get(endpoint)), "publisher", endpoint)
        self._budget.charge(self._endpoints[endpoint], len(cdr))
        self.graph.publish(endpoint, cdr)
        self._count_deliveries()
        self._stored_bound += len(cdr)
        # The exact sum is computed only when the bound exceeds the limit.
        if self._stored_bound > MAX_HELD:
            self._stored_bound = self.graph.count_stored_bytes()
        if self._stored_bound > MAX_HELD:
            raise MemoryLimitError(
                f"messages of more than {MAX_HELD // 2**20} MB were in transit or latched at a "
                "time, so the program was stopped: publish smaller messages, or fewer at a time"
            )

    def _schedule_alarm(self, number: int, due_ns: int, node: int, entity: int) -> None:
        def fire() -> None:
            del self._alarms[number]
            self._send_and_serve(["fire", self.graph.now_ns, number])

        self._check(number not in self._alarms, "alarm", number)
        self._count_entity()
        # A cancelled event counts until its time, because it stays in the heap.
        self._count_deliveries()
        self._alarms[number] = self.graph.call_at(due_ns, fire, node=node, entity=entity)

    def _cancel_alarm(self, number: int) -> None:
        self._check(number in self._alarms, "alarm", number)
        self._alarms.pop(number).cancel()

    def _send_and_serve(self, frame: list[Any], *, serve: bool = True) -> None:
        if self.last_frame is None:
            self._channel.send(frame)
            if serve:
                self.serve()

    def _count_deliveries(self) -> None:
        if self.graph.pending > MAX_DELIVERIES + MAX_ENTITIES:
            raise RecordingLimitError(f"more than {MAX_DELIVERIES} messages were in transit at a time")

    def _count_entity(self, *names: str) -> None:
        count = len(self.nodes) + len(self._endpoints) + len(self._alarms)
        if count >= MAX_ENTITIES or any(len(name) > MAX_NAME for name in names):
            raise RecordingLimitError(
                f"More than {MAX_ENTITIES} nodes, topics and timers were requested, "
                f"or a name of over {MAX_NAME} characters."
            )

    @staticmethod
    def _check(is_owned: bool, kind: str, number: int) -> None:
        if not is_owned:
            raise ChannelError(f"The process refers to {kind} {number}, which it does not own.")


def _endpoint_row(info: EndpointInfo) -> tuple[Any, ...]:
    row = (info.id, info.kind, info.node, info.topic, info.type_name, info.qos.row())
    return *row, info.remote_gid, info.remote_type_hash


def _qos(values: list[Any]) -> Qos:
    try:
        qos = Qos(*values)
    except TypeError as error:
        raise ChannelError(f"Not a QoS: {values!r:.200}") from error
    durations = (qos.deadline_ns, qos.lifespan_ns, qos.lease_ns)
    policies = (qos.history, qos.reliability, qos.durability, qos.liveliness)
    if (
        type(qos.depth) is not int
        or not 0 <= qos.depth <= 10**6
        or not all(isinstance(policy, str) and len(policy) < MAX_WORD for policy in policies)
        or not all(duration is None or type(duration) is int for duration in durations)
    ):
        raise ChannelError(f"Not a QoS: {values!r:.200}")
    return qos


class RemoteAlarm(Alarm):
    """An event in the other process's heap, identified by its number there."""

    __slots__ = ("_graph", "_number")

    def __init__(self, due_ns: int, action: Callable[[], None], graph: "RemoteGraph", number: int) -> None:
        super().__init__(due_ns, action, node=0, entity=0)
        self._graph, self._number = graph, number

    def cancel(self) -> None:
        """Cancel the event in the other process, unless it has already run."""
        if not self.is_cancelled:
            super().cancel()
            if self._graph._alarms.pop(self._number, None) is not None:
                self._graph._channel.queue(["cancel", self._number])


class RemoteGraph(Graph):
    """A graph that runs the events scheduled by the other process, in lock-step with it.

    Because only one side acts at a time, nodes and endpoints can be numbered here, from the other
    graph's `last_id` on, without asking for their numbers.
    """

    def __init__(self, channel: Channel, *, start_ns: int, end_ns: int, last_id: int) -> None:
        super().__init__(start_ns=start_ns, end_ns=end_ns)
        self.last_id = last_id
        self._channel = channel
        self._alarms: dict[int, RemoteAlarm] = {}
        self._last_alarm = 0
        self._publishers: dict[int, EndpointInfo] = {}
        self._on_message: dict[int, OnMessage] = {}

    def add_node(self, name: str, namespace: str) -> int:
        """Add a node. Return its id."""
        self.last_id += 1
        self._channel.queue(["node", self.last_id, name, namespace])
        return self.last_id

    def remove_node(self, node: int) -> None:
        """Remove a node with its endpoints."""
        self._channel.queue(["unnode", node])

    def add_publisher(self, node: int, topic: str, type_name: str, qos: Qos) -> int:
        """Add a publisher. Return its endpoint id."""
        self.last_id += 1
        self._publishers[self.last_id] = EndpointInfo(self.last_id, "pub", node, topic, type_name, qos)
        self._channel.queue(["pub", self.last_id, node, topic, type_name, qos.row()])
        return self.last_id

    def add_subscription(
        self, node: int, entity: int, topic: str, type_name: str, qos: Qos, on_message: OnMessage
    ) -> int:
        """Add a subscription. Return its endpoint id."""
        self.last_id += 1
        self._on_message[self.last_id] = on_message
        self._channel.queue(["sub", self.last_id, node, entity, topic, type_name, qos.row()])
        return self.last_id

    def remove_endpoint(self, endpoint: int) -> None:
        """Remove a publisher or a subscription."""
        self._on_message.pop(endpoint, None)
        self._channel.queue(["unend", endpoint])

    def publish(self, endpoint: int, cdr: bytes) -> None:
        """Publish serialized data, unless the run has ended."""
        if self.ended:
            return
        info = self._publishers[endpoint]
        self._notify_taps(Sample(self.now_ns, info.topic, info.type_name, cdr, info.qos, info.node))
        frame = ["publish", endpoint, cdr]
        # These topics are not part of the evidence.
        if info.topic in OWN_TOPICS:
            self._channel.queue(frame)
        else:
            # Sent immediately, so that it counts even if the program hangs next.
            self._channel.send(frame)

    def call_at(self, due_ns: int, action: Callable[[], None], *, node: int, entity: int) -> Alarm:
        """Schedule `action` for the time `due_ns`, as reported by the other process."""
        self._last_alarm += 1
        number = self._last_alarm
        alarm = self._alarms[number] = RemoteAlarm(due_ns, action, self, number)
        self._channel.queue(["alarm", number, due_ns, node, entity])
        return alarm

    def advance(self) -> bool:
        """Report that this process is idle, and run the event that the other process sends."""
        if self.ended:
            return False
        self._channel.send(["idle"])
        has_more = True
        while has_more:
            name, now_ns, *arguments = self._channel.receive()
            self._advance_to(now_ns)
            has_more = False
            if name == "end":
                self.ended = True
                return False
            if name == "fire":
                self._alarms.pop(arguments[0]).action()
            elif name == "message":
                endpoint, cdr, source_ns, has_more = arguments
                self._on_message[endpoint](cdr, source_ns, now_ns)
            else:
                raise ChannelError(f"Expected fire, message or end, got {name!r}.")
        return True

    def next_due_ns(self) -> int | None:
        """Return None, because only the other process has the events."""
        return None

    def nodes(self) -> list[NodeInfo]:
        """List the nodes in their start order."""
        self._channel.send(["nodes"])
        return [NodeInfo(*row) for row in self._channel.receive()[1]]

    def endpoints(self) -> list[EndpointInfo]:
        """List the publishers and subscriptions, sorted by creation."""
        return self._request_endpoints(["endpoints"])

    def endpoints_on(self, topic: str) -> list[EndpointInfo]:
        """List the publishers and subscriptions of a topic, sorted by creation."""
        return self._request_endpoints(["endpoints_on", topic])

    def _request_endpoints(self, frame: list[Any]) -> list[EndpointInfo]:
        self._channel.send(frame)
        rows = self._channel.receive()[1]
        return [
            EndpointInfo(number, kind, node, topic, type_name, Qos(*qos), *remote)
            for number, kind, node, topic, type_name, qos, *remote in rows
        ]
