"""The graph of one run: robot time, the heap of events that advances it, the nodes and the topics.

Robot time is virtual: it is the time of the last event, and it jumps to the next one when all
threads of the program wait (`course_lib.ros.time.time_lock`). So a run does not depend on the speed
of the computer and repeats exactly. Events of the same time are ordered by node, entity and the
order in which they were scheduled. A published message becomes an event for each matching
subscription, `DELAY_NS` later. A late-joining subscription receives the latched samples of
transient-local publishers likewise.
"""

import heapq
import threading
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, TypeVar

from course_lib.ros.graph.topics import (
    EndpointInfo,
    NodeInfo,
    OnMessage,
    Qos,
    Sample,
    Subscription,
    Topics,
    find_incompatible_policy,
)

__all__ = ["EndpointInfo", "Graph", "NodeInfo", "Sample", "current_graph", "use_graph"]

# Robot time at the start of every run.
START_NS = 1_700_000_000 * 10**9
# Time from publication to delivery.
DELAY_NS = 1_000_000
# Stands for a node id where an event wakes a thread. It sorts after all nodes.
THREADS = 1 << 30

StateT = TypeVar("StateT")
# Returns the topics that a tap needs.
TopicSelector = Callable[[], Collection[str]]


@dataclass(slots=True, eq=False, repr=False)
class Alarm:
    """A scheduled event, which can be cancelled."""

    due_ns: int
    action: Callable[[], None]
    node: int
    entity: int
    is_cancelled: bool = False

    def cancel(self) -> None:
        """Cancel the event."""
        self.is_cancelled = True


@dataclass(frozen=True, slots=True)
class Tap:
    """A listener of all samples, and the topics that a robot has to send for it; None: all topics."""

    listener: Callable[[Sample], None]
    select_topics: TopicSelector | None


class Graph:
    """The nodes and topics of one run, its clock and its scheduled events.

    Args:
        start_ns: Robot time at which the run starts.
        end_ns: Robot time at which it ends, if it does; events due exactly then still run.
        delay_ns: Time from the publication of a message to its delivery.
        notebook: Whether it is a kernel's graph, with the more lenient rules of notebooks.
    """

    # Whether robot time is the wall clock, as with a robot: it cannot be paused, and its speed is
    # fixed.
    keeps_wall_time = False
    # Whether messages pass only between endpoints with compatible QoS.
    is_qos_enforced = True

    def __init__(
        self,
        *,
        start_ns: int = START_NS,
        end_ns: int | None = None,
        delay_ns: int = DELAY_NS,
        notebook: bool = False,
    ) -> None:
        self.end_ns = end_ns
        self.ended = False
        # Nodes that publish a user's actions, one at a time, as RViz does. Their samples never form
        # a burst.
        self.human_nodes: set[int] = set()
        # Whether further samples of the same time follow for the subscription that is receiving
        # one.
        self.has_more = False
        self.notebook = notebook
        # Returns whether the wall clock has reached a robot time.
        self.pace: Callable[[int], bool] | None = None
        # Called after each callback with the entity, the times at which it became ready and began
        # [ns], and its processor time [s].
        self.callback_listeners: list[Callable[[Any, int, int, float], None]] = []
        # Called with the graph and each remote endpoint that has joined (True) or is about to leave
        # (False).
        self.remote_listeners: list[Callable[[Graph, EndpointInfo, bool], None]] = []
        # Names of nodes that a launch has left out, because they cannot run here.
        self.left_out_nodes: set[str] = set()
        # Number of programs started concurrently.
        self.programs = 0
        # State objects by program name and class.
        self._states: dict[str, dict[type, object]] = {}
        self._now_ns = start_ns
        # A heap, ordered by (due time, node, entity, sequence number).
        self._events: list[tuple[int, int, int, int, Alarm]] = []
        self._sequence = 0
        self.delay_ns = delay_ns
        self._topics = Topics()
        self._nodes: dict[int, NodeInfo] = {}
        self._hidden_nodes: set[int] = set()
        # The number that was assigned last to a node or endpoint.
        self.last_id = 0
        self._taps: list[Tap] = []
        self._watchers: list[Callable[[int], None]] = []

    @property
    def now_ns(self) -> int:
        """Robot time, [ns]."""
        return self._now_ns

    def state(self, kind: type[StateT]) -> StateT:
        """Return the calling program's object of a class in this run, created on first use.

        A module that keeps state for a run defines a class for it, which is created without
        arguments.
        """
        states = self._states.setdefault(program.name, {})
        state = states.get(kind)
        if not isinstance(state, kind):
            state = states[kind] = kind()
        return state

    def add_node(self, name: str, namespace: str) -> int:
        """Add a node. Return its id, which is its position in the start order."""
        self.last_id += 1
        self._nodes[self.last_id] = NodeInfo(self.last_id, name, namespace)
        return self.last_id

    def remove_node(self, node: int) -> None:
        """Remove a node with its endpoints."""
        self._nodes.pop(node, None)
        for endpoint in self._topics.endpoints():
            if endpoint.node == node:
                self._topics.remove(endpoint.id)

    def add_publisher(self, node: int, topic: str, type_name: str, qos: Qos) -> int:
        """Add a publisher on a fully qualified topic. Return its endpoint id."""
        self.last_id += 1
        self._topics.add_publisher(EndpointInfo(self.last_id, "pub", node, topic, type_name, qos))
        return self.last_id

    def add_subscription(
        self, node: int, entity: int, topic: str, type_name: str, qos: Qos, on_message: OnMessage
    ) -> int:
        """Add a subscription.

        `on_message(cdr, source_ns, received_ns)` is called for each sample.
        """
        self.last_id += 1
        info = EndpointInfo(self.last_id, "sub", node, topic, type_name, qos)
        subscription = Subscription(info, entity, on_message)
        for sample in self._topics.add_subscription(subscription):
            self._deliver(sample, subscription)
        return self.last_id

    def remove_endpoint(self, endpoint: int) -> None:
        """Remove a publisher or a subscription."""
        self._topics.remove(endpoint)

    def publish(self, endpoint: int, cdr: bytes) -> None:
        """Publish serialized data.

        Each matching subscription receives it as an event after the delay. After the end of the run
        nothing is published.
        """
        if self.ended:
            return
        publisher = self._topics.publishers[endpoint]
        info = publisher.info
        self.show_node(info.node)
        sample = Sample(self.now_ns, info.topic, info.type_name, cdr, info.qos, info.node)
        if info.qos.is_latched:
            publisher.latched.append(sample)
        self._notify_taps(sample)
        for subscription in self._topics.receivers(info):
            self._deliver(sample, subscription)

    def call_at(self, due_ns: int, action: Callable[[], None], *, node: int, entity: int) -> Alarm:
        """Schedule `action` at robot time `due_ns`, in the order of events.

        If that is in the past, it becomes the next event of its time.
        """
        alarm = Alarm(max(due_ns, self._now_ns), action, node, entity)
        self._sequence += 1
        heapq.heappush(self._events, (alarm.due_ns, node, entity, self._sequence, alarm))
        return alarm

    def advance(self) -> bool:
        """Run the next event. If there is none before the end, set `ended` and return False."""
        due_ns = self.next_due_ns()
        at_end = self.end_ns is not None and (due_ns is None or due_ns > self.end_ns)
        target_ns = self.end_ns if at_end else due_ns
        if target_ns is None:
            return False
        if self.pace is not None and not self.pace(target_ns):
            # The wall clock may not have reached the time, because other events may have been
            # scheduled.
            return True
        alarm = None if at_end else heapq.heappop(self._events)[4]
        self._advance_to(target_ns)
        self.ended = at_end
        if alarm is None:
            return False
        # Samples published at the same time reach a subscription together, so that a queue that is
        # too short drops the oldest samples of a burst, as in ROS.
        delivery = alarm.action if isinstance(alarm.action, _Delivery) else None
        is_burst = delivery is not None and delivery.sample.node not in self.human_nodes
        self.has_more = is_burst and self._is_next_for_same_entity(alarm)
        alarm.action()
        while self.has_more:
            alarm = heapq.heappop(self._events)[4]
            self.has_more = self._is_next_for_same_entity(alarm)
            alarm.action()
        return True

    def _is_next_for_same_entity(self, alarm: Alarm) -> bool:
        """Return whether the next event has the same time and entity as `alarm`."""
        if not self._events:
            return False
        due_ns, node, entity, _, next_alarm = self._events[0]
        is_same = (due_ns, node, entity) == (alarm.due_ns, alarm.node, alarm.entity)
        return is_same and not next_alarm.is_cancelled

    def next_due_ns(self) -> int | None:
        """Return the time of the next event [ns], or None."""
        while self._events and self._events[0][4].is_cancelled:
            heapq.heappop(self._events)
        return self._events[0][0] if self._events else None

    @property
    def pending(self) -> int:
        """The number of scheduled events."""
        return len(self._events)

    def count_stored_bytes(self) -> int:
        """Return the serialized size of all samples in transit or kept by publishers, without repeats."""
        samples = {id(sample): sample for p in self._topics.publishers.values() for sample in p.latched}
        for *_, alarm in self._events:
            if isinstance(alarm.action, _Delivery):
                samples[id(alarm.action.sample)] = alarm.action.sample
        return sum(len(sample.cdr) for sample in samples.values())

    def hide_node(self, node: int) -> None:
        """Hide a node and its endpoints from the lists until it wakes or publishes."""
        self._hidden_nodes.add(node)

    def show_node(self, node: int) -> None:
        """List a node and its endpoints again."""
        self._hidden_nodes.discard(node)

    def nodes(self) -> list[NodeInfo]:
        """List the nodes in their start order."""
        return [node for node in self._nodes.values() if node.id not in self._hidden_nodes]

    def endpoints(self) -> list[EndpointInfo]:
        """List the publishers and subscriptions, sorted by creation."""
        return [info for info in self._topics.endpoints() if info.node not in self._hidden_nodes]

    def endpoints_on(self, topic: str) -> list[EndpointInfo]:
        """List the publishers and subscriptions of a topic, sorted by creation."""
        return [info for info in self._topics.endpoints_on(topic) if info.node not in self._hidden_nodes]

    def incompatible_policy(
        self,
        publisher: EndpointInfo,
        subscription: EndpointInfo,
    ) -> str | None:
        """Return the QoS policy that makes a publisher and subscription incompatible, or None."""
        return find_incompatible_policy(publisher.qos, subscription.qos)

    def tap(
        self, listener: Callable[[Sample], None], select_topics: TopicSelector | None = None
    ) -> Callable[[], None]:
        """Call `listener` with every sample on a topic when it is published.

        Return a function that removes the listener. As in `ros2 bag record`, requests and responses
        of services are not included. `select_topics` returns the topics that a robot has to send
        for the listener; None stands for all.
        """
        tap = Tap(listener, select_topics)
        self._taps.append(tap)
        return lambda: self._taps.remove(tap)

    @property
    def is_tapped(self) -> bool:
        """True while viewers or recordings receive published samples."""
        return bool(self._taps)

    def link_report(self) -> list[tuple[str, object]]:
        """Return the state of the link to a robot as `ros2 doctor` rows; empty without a link."""
        return []

    def link_error(self) -> str:
        """Return why nothing is received from the robot, or "" if the link works or is absent."""
        return ""

    def take_blocked_calls(self) -> list[str]:
        """Return the services of which a link has blocked calls since the last query."""
        return []

    def close(self) -> None:
        """Close the link to a robot, if there is one."""

    def watch_time(self, listener: Callable[[int], None]) -> Callable[[], None]:
        """Call `listener(now_ns)` whenever robot time advances.

        Return a function that removes the listener.
        """
        self._watchers.append(listener)
        return lambda: self._watchers.remove(listener)

    def latched_samples(self) -> list[Sample]:
        """List the samples that publishers keep for late-joining subscriptions, oldest first."""
        samples = [sample for p in self._topics.publishers.values() for sample in p.latched]
        return sorted(samples, key=lambda sample: sample.stamp_ns)

    def _notify_taps(self, sample: Sample) -> None:
        for tap in tuple(self._taps) if sample.topic.startswith("/") else ():
            tap.listener(sample)

    def _advance_to(self, now_ns: int) -> None:
        if now_ns > self._now_ns:
            self._now_ns = now_ns
            for watcher in tuple(self._watchers):
                watcher(now_ns)

    def _deliver(self, sample: Sample, subscription: Subscription) -> None:
        """Schedule the delivery of a sample to a subscription."""
        # Such events would wait, with their samples, while a program publishes faster than it spins.
        if subscription.on_message is ignore:
            return
        delivery = _Delivery(self, sample, subscription)
        node, entity = subscription.info.node, subscription.entity
        self.call_at(self.now_ns + self.delay_ns, delivery, node=node, entity=entity)


def ignore(cdr: bytes, source_ns: int, received_ns: int) -> None:
    """Do nothing: the network delivers to remote subscriptions, and taps receive every sample."""


@dataclass(slots=True, eq=False, repr=False)
class _Delivery:
    """The event that delivers a sample to a subscription, unless it was removed in the meantime.

    `Graph.count_stored_bytes` accesses its sample.
    """

    graph: Graph
    sample: Sample
    subscription: Subscription

    def __call__(self) -> None:
        graph, sample, subscription = self.graph, self.sample, self.subscription
        if subscription.info.id in graph._topics.subscriptions:
            subscription.on_message(sample.cdr, sample.stamp_ns, graph.now_ns)


@dataclass
class ProgramNodes:
    """The nodes of one program."""

    # The ids of the nodes, which leave the graph when the program ends.
    ids: set[int] = field(default_factory=set)
    # The full names, by id, of nodes with ready entities that were never added to an executor.
    unspun_nodes: dict[int, str] = field(default_factory=dict)
    # The number of timers and subscriptions, by full name, of nodes that were never added to an
    # executor.
    callbacks: dict[str, int] = field(default_factory=dict)
    # Functions that find slips of the program when it has ended.
    find_slips: list[Callable[[], Iterable[str]]] = field(default_factory=list)
    # The errors that stopped live nodes, by full name. Nodes of one run have the same error.
    errors: dict[str, str] = field(default_factory=dict)

    def forget_error(self, full_name: str) -> None:
        """Remove the error of a run, because one of its nodes, or a node of the same name, is spun."""
        error = self.errors.get(full_name)
        if error is not None:
            self.errors = {name: other for name, other in self.errors.items() if other != error}


class _ProgramName(threading.local):
    name = ""


# The program of the calling thread. Several programs can share a graph.
program = _ProgramName()
_current = Graph()


def current_graph() -> Graph:
    """Return the graph that the stand-in uses."""
    return _current


def set_graph(graph: Graph) -> None:
    """Replace the current graph."""
    global _current
    _current = graph


@contextmanager
def use_graph(graph: Graph) -> Iterator[Graph]:
    """Make another graph the current one for the length of a `with` block."""
    previous = _current
    set_graph(graph)
    try:
        yield graph
    finally:
        set_graph(previous)
