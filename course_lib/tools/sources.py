"""Where the tools look: at the nodes of a run, or at a recording."""

from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from typing import Protocol

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros.driving import running_nodes, wait_for
from course_lib.ros.graph import EndpointInfo, Graph
from course_lib.ros.messages import Message, deserialize, message_class
from course_lib.ros.qos import Qos, incompatible

ALWAYS_THERE = {  # topics of every ROS node, the command line's own among them
    "/parameter_events": ["rcl_interfaces/msg/ParameterEvent"],
    "/rosout": ["rcl_interfaces/msg/Log"],
}
NODE_NAME = "_ros2cli"  # ROS hides names that begin with an underscore


class Source(Protocol):
    """What the tools want to know."""

    live: bool  # whether messages may come for ever

    def topics(self) -> dict[str, list[str]]:
        """Give each topic's types, sorted."""

    def offered(self, topic: str) -> list[Qos]:
        """Give the QoS that the topic's publishers offer."""

    def count(self, topic: str) -> tuple[int, int]:
        """Count the topic's publishers and subscriptions."""

    def messages(
        self, topic: str, type_name: str, qos: Qos, *, patience: float, seconds: float | None
    ) -> Iterator[Message]:
        """Yield messages; ends after `patience` [s] without one, or after `seconds` [s] in all."""

    def stream(
        self, topics: Mapping[str, Qos], type_name: str, *, every: float, seconds: float | None
    ) -> Iterator[tuple[int, str, Message | None]]:
        """Yield (robot time [ns], topic, message) of several topics, and no message once per `every` [s]."""

    def why_silent(self, topic: str, qos: Qos) -> str:
        """Say what keeps messages from coming, as a sentence with a space before it, or ""."""


class GraphSource:
    """The nodes of a run; waiting for messages drives those that run live."""

    live = True

    def __init__(self, graph: Graph) -> None:
        self._graph = graph

    def topics(self) -> dict[str, list[str]]:
        """Give each topic's types, sorted; with those that are always there."""
        found = {name: set(types) for name, types in ALWAYS_THERE.items()}
        for endpoint in (e for e in self._graph.endpoints() if e.service is None):
            found.setdefault(endpoint.topic, set()).add(endpoint.type_name)
        return {name: sorted(found[name]) for name in sorted(found)}

    def offered(self, topic: str) -> list[Qos]:
        """Give the QoS that the topic's publishers offer."""
        return [endpoint.qos for endpoint in self._on(topic) if endpoint.kind == "pub"]

    def count(self, topic: str) -> tuple[int, int]:
        """Count the topic's publishers and subscriptions."""
        publishers = len(self.offered(topic))
        return publishers, len(self._on(topic)) - publishers

    def messages(
        self, topic: str, type_name: str, qos: Qos, *, patience: float, seconds: float | None
    ) -> Iterator[Message]:
        """Yield what arrives at a subscription of our own; times are robot time.

        Raises:
            CourseError: rclpy has not been started.
        """
        end_ns = None if seconds is None else self._graph.now_ns + round(seconds * 1e9)
        with self._heard({topic: qos}, type_name) as arrived:
            while arrived or wait_for(lambda: bool(arrived), seconds=self._left(patience, end_ns)):
                yield arrived.popleft()[2]

    def stream(
        self, topics: Mapping[str, Qos], type_name: str, *, every: float, seconds: float | None
    ) -> Iterator[tuple[int, str, Message | None]]:
        """Yield what arrives at subscriptions of our own, and no message at the start and every while."""
        next_ns = self._graph.now_ns
        end_ns = None if seconds is None else next_ns + round(seconds * 1e9)
        with self._heard(topics, type_name) as arrived:
            while end_ns is None or next_ns <= end_ns:
                wait_for(lambda: bool(arrived), seconds=max(0, next_ns - self._graph.now_ns) * 1e-9)
                while arrived:
                    yield arrived.popleft()
                if self._graph.now_ns >= next_ns:
                    yield self._graph.now_ns, "", None
                    next_ns += round(every * 1e9)

    def why_silent(self, topic: str, qos: Qos) -> str:
        """Say what keeps messages from coming."""
        offered = self.offered(topic)
        if not offered:
            return " Nobody publishes on it."
        policies = [incompatible(one, qos) for one in offered]
        if all(policies):
            return f" Its publishers offer incompatible QoS: {policies[0]}."
        return "" if running_nodes() else " No node is running: start one, like run_live(MyNode())."

    @contextmanager
    def _heard(self, topics: Mapping[str, Qos], type_name: str) -> Iterator[deque[tuple[int, str, Message]]]:
        """Subscribe for a while; gives what arrives."""
        import rclpy

        if not rclpy.ok():
            raise CourseError(
                "rclpy is not started: call rclpy.init() and run a node, like run_live(MyNode())."
            )
        arrived: deque[tuple[int, str, Message]] = deque()
        cls = message_class(type_name)

        def hear(topic: str, cdr: bytes, _: int, received_ns: int) -> None:
            arrived.append((received_ns, topic, deserialize(cdr, cls)))

        node = self._graph.add_node(NODE_NAME, "/")
        try:
            for topic, qos in topics.items():
                self._graph.add_subscription(node, 0, topic, type_name, qos, partial(hear, topic))
            yield arrived
        finally:
            self._graph.remove_node(node)

    def _on(self, topic: str) -> list[EndpointInfo]:
        return [endpoint for endpoint in self._graph.endpoints() if endpoint.topic == topic]

    def _left(self, patience: float, end_ns: int | None) -> float:
        """Give the robot time to wait for the next message, [s]."""
        return patience if end_ns is None else min(patience, max(0, end_ns - self._graph.now_ns) * 1e-9)


class RecordingSource:
    """A recording: as if it were played, in no time."""

    live = False

    def __init__(self, recording: Recording) -> None:
        self._recording = recording

    def topics(self) -> dict[str, list[str]]:
        """Give each topic's types, sorted."""
        found: dict[str, list[str]] = {}
        for topic in self._recording.topics():
            found.setdefault(topic.name, []).append(topic.type_name)
        return found

    def offered(self, topic: str) -> list[Qos]:
        """Give the QoS that the topic's publishers offered."""
        return [qos for found in self._recording.topics() if found.name == topic for qos in found.offered]

    def count(self, topic: str) -> tuple[int, int]:
        """Count the topic's publishers, as far as their QoS tells them apart; nobody subscribes."""
        return len(self.offered(topic)), 0

    def messages(
        self, topic: str, type_name: str, qos: Qos, *, patience: float, seconds: float | None
    ) -> Iterator[Message]:
        """Yield what was recorded in the first `seconds` [s]."""
        end_ns = None if seconds is None else self._recording.start_ns + round(seconds * 1e9)
        for stamp_ns, message in self._recording.messages(topic):
            if end_ns is None or stamp_ns <= end_ns:
                yield message

    def stream(
        self, topics: Mapping[str, Qos], type_name: str, *, every: float, seconds: float | None
    ) -> Iterator[tuple[int, str, Message | None]]:
        """Yield what was recorded in the first `seconds` [s], and no message at the start and every while."""
        next_ns, end_ns = self._recording.start_ns, self._recording.end_ns
        if seconds is not None:
            end_ns = next_ns + round(seconds * 1e9)
        samples = deque(s for s in self._recording.samples if s.topic in topics and s.type_name == type_name)
        while next_ns <= end_ns:
            while samples and samples[0].stamp_ns <= next_ns:
                sample = samples.popleft()
                yield sample.stamp_ns, sample.topic, deserialize(sample.cdr, message_class(type_name))
            yield next_ns, "", None
            next_ns += round(every * 1e9)

    def why_silent(self, topic: str, qos: Qos) -> str:
        """A recorded topic has messages: only a time limit keeps them away."""
        return " All of them were recorded later."
