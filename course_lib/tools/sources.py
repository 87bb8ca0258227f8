"""Sources of data for the tools: the nodes of a run, or a recording.

A tool works the same way on both. A recording is streamed as if it were played, with the
player as its only node, so `ros2 topic hz` gives the same result for both.
"""

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros.graph.graph import EndpointInfo, Graph, Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.time import pace
from course_lib.ros.time.driving import running_nodes, wait_for

if TYPE_CHECKING:
    from rclpy.node import Node
    from rclpy.task import Future

# Topics of every ROS node, including the node of the command line.
ALWAYS_THERE = {
    "/parameter_events": ["rcl_interfaces/msg/ParameterEvent"],
    "/rosout": ["rcl_interfaces/msg/Log"],
}
# ROS hides nodes whose names begin with an underscore.
NODE_NAME = "_ros2cli"
# The node that publishes when ROS plays a recording.
PLAYER = "rosbag2_player"
# Time that ros2cli waits for discovery [s].
DISCOVERY = 0.5

# The QoS of the subscription by name and type of the topic.
Topics = Mapping[tuple[str, str], Qos]
# Robot time [ns] and a message; None at a tick of the clock.
TimedSample = tuple[int, Sample | None]


@dataclass(frozen=True, slots=True)
class StreamLimits:
    """Limits of a stream: total time, time without a message, and the period of its ticks, [s]."""

    seconds: float | None = None
    idle_seconds: float | None = None
    # Interval between ticks [s]; the first tick is at the start.
    every: float | None = None


class Source(ABC):
    """Topics, endpoints and messages for tools.

    Args:
        graph: The graph that contains the nodes.
        always_there: Types of topics that exist even without nodes.
    """

    # Whether nodes run that can be called and waited for.
    is_live: bool
    # Time to wait for nodes that are still starting [s].
    discovery = 0.0

    def __init__(self, graph: Graph, always_there: Mapping[str, list[str]]) -> None:
        self.graph = graph
        self._permanent_topics = always_there

    def topics(self, *, with_hidden: bool = True) -> dict[str, list[str]]:
        """Return the sorted types of each topic by name."""
        types_by_topic = {name: set(types) for name, types in self._permanent_topics.items()}
        for endpoint in (e for e in self.graph.endpoints() if e.service is None):
            types_by_topic.setdefault(endpoint.topic, set()).add(endpoint.type_name)
        return {
            name: sorted(types_by_topic[name])
            for name in sorted(types_by_topic)
            if with_hidden or not is_hidden(name)
        }

    def endpoints(self, topic: str, kind: Literal["pub", "sub"]) -> list[EndpointInfo]:
        """List a topic's publishers or subscriptions."""
        return [endpoint for endpoint in self.graph.endpoints_on(topic) if endpoint.kind == kind]

    def limit(self, enough: float = pace.SECONDS_WITHOUT_A_PAGE) -> float | None:
        """Return the time limit of an endless tool [s]: `enough`, or None until ■ or the end of the run."""
        return None

    @abstractmethod
    def wait(self, ready: Callable[[], bool], seconds: float | None) -> bool:
        """Wait until `ready()` is true, at most `seconds` [s] of robot time.

        Return the last value of `ready()`.
        """

    @abstractmethod
    def stream(self, topics: Topics, limits: StreamLimits) -> Iterator[TimedSample]:
        """Yield the messages of topics, and ticks."""

    @abstractmethod
    def silence_reason(self, topic: str, qos: Qos) -> str:
        """Return why a topic has no messages, as a sentence after a space, or ""."""


class GraphSource(Source):
    """The nodes of a run. Waiting for messages runs the live nodes."""

    is_live = True

    def __init__(self, graph: Graph, *, discovery: float = 0.0, interrupted: bool = False) -> None:
        super().__init__(graph, ALWAYS_THERE)
        self.discovery, self._interrupted = discovery, interrupted

    def limit(self, enough: float = pace.SECONDS_WITHOUT_A_PAGE) -> float | None:
        """Return `enough` [s] in a notebook without a page, unless %timeout ends the tool; else None."""
        has_time_limit = self.graph.notebook and pace.mode() == "fast" and not self._interrupted
        return enough if has_time_limit else None

    def wait(self, ready: Callable[[], bool], seconds: float | None) -> bool:
        """Wait, or raise a CourseError if rclpy has not been initialized."""
        import rclpy

        if not rclpy.ok():
            raise CourseError(
                "rclpy is not initialized: call rclpy.init() and run a node, like run_live(MyNode())."
            )
        return wait_for(ready, seconds=seconds)

    def stream(self, topics: Topics, limits: StreamLimits) -> Iterator[TimedSample]:
        """Yield the messages received by the subscriptions of a separate node, and ticks."""
        graph, every = self.graph, limits.every
        start_ns = last_received_ns = tick_ns = graph.now_ns
        with self._arrivals(topics) as arrived:
            while True:
                spans = [(start_ns, limits.seconds), (last_received_ns, limits.idle_seconds)]
                deadlines_ns = [since_ns + round(time * 1e9) for since_ns, time in spans if time is not None]
                due_ns = [*deadlines_ns, tick_ns] if every else deadlines_ns
                remaining = max(0, min(due_ns) - graph.now_ns) * 1e-9 if due_ns else None
                if self.wait(lambda: bool(arrived), remaining):
                    last_received_ns, sample = arrived.popleft()
                    yield last_received_ns, sample
                elif every and graph.now_ns >= tick_ns:
                    yield graph.now_ns, None
                    tick_ns += round(every * 1e9)
                elif graph.ended or (deadlines_ns and graph.now_ns >= min(deadlines_ns)):
                    return

    def silence_reason(self, topic: str, qos: Qos) -> str:
        """Return a sentence about missing publishers, incompatible QoS or missing nodes, or ""."""
        publishers = self.endpoints(topic, "pub")
        if not publishers:
            return " It has no publisher."
        other_subscriptions = self.endpoints(topic, "sub")
        # A linked robot accepts all QoS, because Zenoh does not compare them.
        with self._arrivals({(topic, publishers[0].type_name): qos}):
            own_subscription = next(
                info for info in self.endpoints(topic, "sub") if info not in other_subscriptions
            )
            policies = [self.graph.incompatible_policy(p, own_subscription) for p in publishers]
        if all(policies):
            return f" Its publishers offer incompatible QoS: {policies[0]}."
        if running_nodes() or not self.graph.notebook:
            return ""
        return " No node is running: start one, like run_live(MyNode())."

    @contextmanager
    def _arrivals(self, topics: Topics) -> Iterator[deque[tuple[int, Sample]]]:
        """Subscribe to topics during a `with` block, and provide a queue of their messages."""
        arrived: deque[tuple[int, Sample]] = deque()
        node = self.graph.add_node(NODE_NAME, "/")

        def receive(topic: tuple[str, str], cdr: bytes, source_ns: int, received_ns: int) -> None:
            arrived.append((received_ns, Sample(source_ns, *topic, cdr, topics[topic], node)))

        try:
            for topic, qos in topics.items():
                self.graph.add_subscription(node, 0, *topic, qos, partial(receive, topic))
            yield arrived
        finally:
            self.graph.remove_node(node)


class RecordingSource(Source):
    """A recording, streamed as if it were played, without taking time."""

    is_live = False

    def __init__(self, recording: Recording) -> None:
        super().__init__(Graph(start_ns=recording.start_ns), {})
        self.recording = recording
        player = self.graph.add_node(PLAYER, "/")
        for topic in recording.topics():
            for qos in topic.offered:
                self.graph.add_publisher(player, topic.name, topic.type_name, qos)

    def wait(self, ready: Callable[[], bool], seconds: float | None) -> bool:
        """Return `ready()`, because nothing changes in a recording."""
        return ready()

    def stream(self, topics: Topics, limits: StreamLimits) -> Iterator[TimedSample]:
        """Yield the recorded messages, and ticks."""
        tick_ns, end_ns = self.recording.start_ns, self.recording.end_ns
        step_ns = round((limits.every or 0.0) * 1e9)
        if limits.seconds is not None:
            end_ns = tick_ns + round(limits.seconds * 1e9)
        for sample in (*self.recording.samples, None):
            while step_ns and tick_ns <= end_ns and (sample is None or tick_ns < sample.stamp_ns):
                yield tick_ns, None
                tick_ns += step_ns
            if sample is None or sample.stamp_ns > end_ns:
                return
            if (sample.topic, sample.type_name) in topics:
                yield sample.stamp_ns, sample

    def silence_reason(self, topic: str, qos: Qos) -> str:
        """Return the sentence that all messages of the topic were recorded after the time limit."""
        return " All of them were recorded later."


def is_hidden(name: str) -> bool:
    """Return whether a component of a topic, service or node name begins with an underscore."""
    return any(name_part.startswith("_") for name_part in name.split("/"))


@contextmanager
def own_node(
    source: Source,
    name: str = NODE_NAME,
    *,
    use_sim_time: bool = False,
) -> "Iterator[Node]":
    """Run a separate node together with the live ones within a `with` block.

    Raises:
        CourseError: The source is a recording, or the name is not valid for a node.
    """
    if not source.is_live:
        raise CourseError("A recording cannot respond. Use running nodes: course ros2 --run program.py …")
    # This raises an error if rclpy is not initialized.
    source.wait(lambda: True, 0.0)
    from rclpy.exceptions import InvalidNodeNameException
    from rclpy.node import Node
    from rclpy.parameter import Parameter

    time = Parameter("use_sim_time", value=use_sim_time)
    try:
        node = Node(name, start_parameter_services=False, enable_rosout=False, parameter_overrides=[time])
    except InvalidNodeNameException as error:
        raise CourseError(str(error)) from error
    running_nodes().append(node)
    try:
        yield node
    finally:
        running_nodes().remove(node)
        node.destroy_node()


def wait_for_response(
    source: Source,
    future: "Future[Any]",
    server: str,
    seconds: float | None,
    has_server: Callable[[], bool] = lambda: True,
) -> Any:
    """Return a future's result.

    Raise a CourseError if it is not complete after a number of seconds, if the server disappears,
    or if a link has blocked the call.
    """
    blocked = [name for name in source.graph.take_blocked_calls() if f"{name}/".startswith(f"{server}/")]
    if blocked:
        # An action is allowed as a whole, but a node's services for parameters one by one.
        service = blocked[0].partition("/_action/")[0]
        raise CourseError(
            f"{service} was not called, because the link to the robot does not allow it. "
            f"To call it, connect with --call {service}"
        )
    if not source.wait(lambda: not (future._pending() and has_server()), seconds):
        raise CourseError(f"{server} does not respond. Is it running? Start it, like run_live(node).")
    if future._pending():
        raise CourseError(f"{server} has disappeared before it responded. Start its node again, then repeat.")
    return future.result()
