"""The graph as a student's process sees it: its clock and its topics are at the other end of a pipe."""

from collections.abc import Callable
from typing import Any

from course_lib.ros.channel import Channel, ChannelError
from course_lib.ros.clock import Alarm
from course_lib.ros.graph import Graph
from course_lib.ros.qos import Qos
from course_lib.ros.topics import OWN_TOPICS, EndpointInfo, NodeInfo, OnMessage, Sample


class RemoteAlarm(Alarm):
    """An event in the other process's heap."""

    __slots__ = ("_tell",)

    def __init__(self, due_ns: int, action: Callable[[], None], tell: Callable[[], None]) -> None:
        super().__init__(due_ns, action)
        self._tell = tell

    def cancel(self) -> None:
        """Cancel the event in the other process."""
        if not self.cancelled:
            super().cancel()
            self._tell()


class RemoteGraph(Graph):
    """Lock-step: every event comes from the other process, which waits until this one is idle again.

    So nodes and endpoints have the next numbers, from `last_id` of the other graph on, without a question.
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
        """Add a node; returns its id."""
        self.last_id += 1
        self._channel.queue(["node", self.last_id, name, namespace])
        return self.last_id

    def remove_node(self, node: int) -> None:
        """Remove a node with its endpoints."""
        self._channel.queue(["unnode", node])

    def add_publisher(self, node: int, topic: str, type_name: str, qos: Qos) -> int:
        """Add a publisher; returns its endpoint id."""
        self.last_id += 1
        self._publishers[self.last_id] = EndpointInfo(self.last_id, "pub", node, topic, type_name, qos)
        self._channel.queue(["pub", self.last_id, node, topic, type_name, qos.row()])
        return self.last_id

    def add_subscription(
        self, node: int, entity: int, topic: str, type_name: str, qos: Qos, on_message: OnMessage
    ) -> int:
        """Add a subscription; returns its endpoint id."""
        self.last_id += 1
        self._on_message[self.last_id] = on_message
        self._channel.queue(["sub", self.last_id, node, entity, topic, type_name, qos.row()])
        return self.last_id

    def remove_endpoint(self, endpoint: int) -> None:
        """Remove a publisher or a subscription."""
        self._on_message.pop(endpoint, None)
        self._channel.queue(["unend", endpoint])

    def publish(self, endpoint: int, cdr: bytes) -> None:
        """Publish serialised data, unless the run has ended."""
        if self.ended:
            return
        info = self._publishers[endpoint]
        self._show(Sample(self.now_ns, info.topic, info.type_name, cdr, info.qos, info.node))
        frame = ["publish", endpoint, cdr]
        if info.topic in OWN_TOPICS:  # they are no evidence
            self._channel.queue(frame)
        else:
            self._channel.send(frame)  # at once: it counts even if the program hangs next

    def call_at(self, due_ns: int, action: Callable[[], None], *, node: int, entity: int) -> Alarm:
        """Schedule `action` for the time when the other process reports that `due_ns` has come."""
        self._last_alarm += 1
        number = self._last_alarm
        alarm = RemoteAlarm(due_ns, action, lambda: self._cancel(number))
        self._alarms[number] = alarm
        self._channel.queue(["alarm", number, due_ns, node, entity])
        return alarm

    def advance(self) -> bool:
        """Report that this process is idle, and run the event that the other one sends."""
        if self.ended:
            return False
        self._channel.send(["idle"])
        name, now_ns, *rest = self._channel.receive()
        self._move_to(now_ns)
        if name == "end":
            self.ended = True
            return False
        if name == "fire":
            self._alarms.pop(rest[0]).action()
        elif name == "message":
            self._on_message[rest[0]](rest[1], rest[2], now_ns)
        else:
            raise ChannelError(f"Expected fire, message or end, got {name!r}.")
        return True

    def next_due_ns(self) -> int | None:
        """Only the other process knows."""
        return None

    def nodes(self) -> list[NodeInfo]:
        """List the nodes in their start order."""
        return [NodeInfo(*row) for row in self._ask(["nodes"])[0]]

    def endpoints(self) -> list[EndpointInfo]:
        """List the publishers and subscriptions in the order of their making."""
        return self._endpoints(["endpoints"])

    def endpoints_on(self, topic: str) -> list[EndpointInfo]:
        """List the publishers and subscriptions of a topic in the order of their making."""
        return self._endpoints(["endpoints_on", topic])

    def _endpoints(self, frame: list[Any]) -> list[EndpointInfo]:
        rows = self._ask(frame)[0]
        return [EndpointInfo(i, kind, node, topic, of, Qos(*qos)) for i, kind, node, topic, of, qos in rows]

    def _ask(self, frame: list[Any]) -> list[Any]:
        self._channel.send(frame)
        return self._channel.receive()[1:]

    def _cancel(self, number: int) -> None:
        if self._alarms.pop(number, None) is not None:
            self._channel.queue(["cancel", number])
