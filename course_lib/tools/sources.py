"""Where the tools look: at the nodes of a run, or at a recording."""

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Literal

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros import pace
from course_lib.ros.driving import running_nodes, wait_for
from course_lib.ros.graph import EndpointInfo, Graph, Sample
from course_lib.ros.qos import Qos, incompatible

ALWAYS_THERE = {  # topics of every ROS node, the command line's own among them
    "/parameter_events": ["rcl_interfaces/msg/ParameterEvent"],
    "/rosout": ["rcl_interfaces/msg/Log"],
}
NODE_NAME = "_ros2cli"  # ROS hides names that begin with an underscore
PLAYER = "rosbag2_player"  # the node that publishes when ROS plays a recording
DISCOVERY = 0.5  # [s] that ros2cli looks for nodes before it says what there is


Heard = tuple[int, Sample | None]  # robot time [ns], and what came; nothing where only time went by


@dataclass(frozen=True, slots=True)
class Listening:
    """How long a tool listens, in all and without a message, and how often it is told the time, [s]."""

    seconds: float | None = None
    patience: float | None = None
    every: float | None = None  # the first time at the start


class Source(ABC):
    """What the tools want to know.

    Args:
        graph: The nodes to look at.
        always_there: Topics that are there without them, with their types.
    """

    live: bool  # whether nodes run that can be asked and waited for
    discovery = 0.0  # [s] to wait for nodes that are coming up

    def __init__(self, graph: Graph, always_there: Mapping[str, list[str]]) -> None:
        self.graph = graph
        self._always_there = always_there

    def topics(self, *, hidden: bool = True) -> dict[str, list[str]]:
        """Give each topic's types, sorted; with those that are always there, if wanted with hidden ones."""
        found = {name: set(types) for name, types in self._always_there.items()}
        for endpoint in (e for e in self.graph.endpoints() if e.service is None):
            found.setdefault(endpoint.topic, set()).add(endpoint.type_name)
        return {name: sorted(found[name]) for name in sorted(found) if hidden or not is_hidden(name)}

    def endpoints(self, topic: str, kind: Literal["pub", "sub"]) -> list[EndpointInfo]:
        """List a topic's publishers or subscriptions."""
        return [e for e in self.graph.endpoints() if e.topic == topic and e.kind == kind]

    def offered(self, topic: str) -> list[Qos]:
        """Give the QoS that the topic's publishers offer."""
        return [endpoint.qos for endpoint in self.endpoints(topic, "pub")]

    def limit(self, enough: float = pace.SECONDS_WITHOUT_A_PAGE) -> float | None:
        """Say how long an endless tool goes on, [s], if `enough` will do; None: until ■, or the end."""
        return None

    @abstractmethod
    def wait(self, ready: Callable[[], bool], seconds: float | None) -> bool:
        """Let time go by until it is ready, at most so much robot time [s]; says whether it is."""

    @abstractmethod
    def stream(self, topics: Mapping[str, Qos], type_name: str, listening: Listening) -> Iterator[Heard]:
        """Yield the messages of several topics, and the time."""

    @abstractmethod
    def why_silent(self, topic: str, qos: Qos) -> str:
        """Say what keeps messages from coming, as a sentence with a space before it, or ""."""


class GraphSource(Source):
    """The nodes of a run; waiting for messages drives those that run live."""

    live = True

    def __init__(self, graph: Graph, *, discovery: float = 0.0) -> None:
        super().__init__(graph, ALWAYS_THERE)
        self.discovery = discovery

    def limit(self, enough: float = pace.SECONDS_WITHOUT_A_PAGE) -> float | None:
        """Without a page nobody presses ■; outside of notebooks a run has its own end."""
        return enough if self.graph.notebook and pace.wanted() == "fast" else None

    def wait(self, ready: Callable[[], bool], seconds: float | None) -> bool:
        """Wait; raises a CourseError if rclpy has not been started."""
        import rclpy

        if not rclpy.ok():
            raise CourseError(
                "rclpy is not started: call rclpy.init() and run a node, like run_live(MyNode())."
            )
        return wait_for(ready, seconds=seconds)

    def stream(self, topics: Mapping[str, Qos], type_name: str, listening: Listening) -> Iterator[Heard]:
        """Yield what arrives at subscriptions of our own."""
        graph, every = self.graph, listening.every
        start_ns = heard_ns = tick_ns = graph.now_ns
        with self._heard(topics, type_name) as arrived:
            while True:
                limits = [(start_ns, listening.seconds), (heard_ns, listening.patience)]
                ends = [since + round(time * 1e9) for since, time in limits if time is not None]
                due = [*ends, tick_ns] if every else ends
                left = max(0, min(due) - graph.now_ns) * 1e-9 if due else None
                if self.wait(lambda: bool(arrived), left):
                    heard_ns, sample = arrived.popleft()
                    yield heard_ns, sample
                elif every and graph.now_ns >= tick_ns:
                    yield graph.now_ns, None
                    tick_ns += round(every * 1e9)
                elif graph.ended or (ends and graph.now_ns >= min(ends)):
                    return

    def why_silent(self, topic: str, qos: Qos) -> str:
        """Say what keeps messages from coming."""
        offered = self.offered(topic)
        if not offered:
            return " Nobody publishes on it."
        policies = [incompatible(one, qos) for one in offered]
        if all(policies):
            return f" Its publishers offer incompatible QoS: {policies[0]}."
        if running_nodes() or not self.graph.notebook:
            return ""
        return " No node is running: start one, like run_live(MyNode())."

    @contextmanager
    def _heard(self, topics: Mapping[str, Qos], type_name: str) -> Iterator[deque[tuple[int, Sample]]]:
        """Subscribe for a while; gives what arrives."""
        arrived: deque[tuple[int, Sample]] = deque()

        node = self.graph.add_node(NODE_NAME, "/")

        def hear(topic: str, cdr: bytes, source_ns: int, received_ns: int) -> None:
            sample = Sample(source_ns, topic, type_name, cdr, topics[topic], node)  # as it was heard
            arrived.append((received_ns, sample))

        try:
            for topic, qos in topics.items():
                self.graph.add_subscription(node, 0, topic, type_name, qos, partial(hear, topic))
            yield arrived
        finally:
            self.graph.remove_node(node)


class RecordingSource(Source):
    """A recording: as if it were played, in no time."""

    live = False

    def __init__(self, recording: Recording) -> None:
        super().__init__(Graph(start_ns=recording.start_ns), {})
        self.recording = recording
        player = self.graph.add_node(PLAYER, "/")
        for topic in recording.topics():
            for qos in topic.offered:
                self.graph.add_publisher(player, topic.name, topic.type_name, qos)

    def wait(self, ready: Callable[[], bool], seconds: float | None) -> bool:
        """Say whether it is ready: nothing changes any more."""
        return ready()

    def stream(self, topics: Mapping[str, Qos], type_name: str, listening: Listening) -> Iterator[Heard]:
        """Yield what was recorded; a recording keeps nobody waiting."""
        tick_ns, end_ns = self.recording.start_ns, self.recording.end_ns
        step_ns = round((listening.every or 0.0) * 1e9)
        if listening.seconds is not None:
            end_ns = tick_ns + round(listening.seconds * 1e9)
        for sample in (*self.recording.samples, None):
            while step_ns and tick_ns <= end_ns and (sample is None or tick_ns < sample.stamp_ns):
                yield tick_ns, None
                tick_ns += step_ns
            if sample is None or sample.stamp_ns > end_ns:
                return
            if sample.topic in topics and sample.type_name == type_name:
                yield sample.stamp_ns, sample

    def why_silent(self, topic: str, qos: Qos) -> str:
        """A recorded topic has messages: only a time limit keeps them away."""
        return " All of them were recorded later."


def is_hidden(name: str) -> bool:
    """Say whether ROS hides a topic, a service or a node: a part of its name begins with an underscore."""
    return any(part.startswith("_") for part in name.split("/"))
