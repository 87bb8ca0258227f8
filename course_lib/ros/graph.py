"""One run: its clock, its nodes and its topics."""

import threading
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, TypeVar

from course_lib.ros.clock import START_NS, Alarm, Clock
from course_lib.ros.qos import Qos, incompatible
from course_lib.ros.topics import EndpointInfo, NodeInfo, OnMessage, Sample, Subscription, Topics

__all__ = ["EndpointInfo", "Graph", "NodeInfo", "Sample", "current_graph", "use_graph"]

DELAY_NS = 1_000_000  # [ns] from publication to delivery
PartT = TypeVar("PartT")
Wanted = Callable[[], Collection[str]]  # the topics that a tap needs


class Graph:
    """The nodes and topics of one run and the clock that owns its events.

    Args:
        start_ns: Robot time at which the run starts.
        end_ns: Robot time of its end, if it has one; events due exactly then still happen.
        delay_ns: From the publication of a message to its delivery.
        notebook: A kernel's own graph, with the forgiving rules of a notebook.
    """

    keeps_wall_time = False  # True where robot time is the wall clock: no pause, no other speed

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
        self.notebook = notebook
        self.pace: Callable[[int], bool] | None = None  # says whether the wall clock has come to a time
        # called after each callback: entity, ready since [ns], begun at [ns], processor time [s]
        self.callback_listeners: list[Callable[[Any, int, int, float], None]] = []
        self.programs = 0  # how many were started beside each other
        self._parts: dict[str, dict[type, object]] = {}  # by program
        self._clock = Clock(start_ns)
        self.delay_ns = delay_ns
        self._topics = Topics()
        self._nodes: dict[int, NodeInfo] = {}
        self._resting: set[int] = set()
        self.last_id = 0  # the number that was given last to a node or an endpoint
        self._taps: list[tuple[Callable[[Sample], None], Wanted | None]] = []
        self._watchers: list[Callable[[int], None]] = []

    @property
    def now_ns(self) -> int:
        """Robot time, [ns]."""
        return self._clock.now_ns

    def part(self, kind: type[PartT]) -> PartT:
        """Return the calling program's object of a class in this run, made on first use.

        A module that keeps state for a run defines a class for it, which is made without arguments.
        """
        parts = self._parts.setdefault(program.name, {})
        found = parts.get(kind)
        if not isinstance(found, kind):
            found = parts[kind] = kind()
        return found

    def add_node(self, name: str, namespace: str) -> int:
        """Add a node; returns its id, which is its start order."""
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
        """Add a publisher on a fully resolved topic; returns its endpoint id."""
        self.last_id += 1
        self._topics.add_publisher(EndpointInfo(self.last_id, "pub", node, topic, type_name, qos))
        return self.last_id

    def add_subscription(
        self, node: int, entity: int, topic: str, type_name: str, qos: Qos, on_message: OnMessage
    ) -> int:
        """Add a subscription; `on_message(cdr, source_ns, received_ns)` is called for each sample."""
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
        """Publish serialised data; it reaches each matching subscription as an event after the delay.

        After the end of the run nothing is published any more.
        """
        if self.ended:
            return
        publisher = self._topics.publishers[endpoint]
        info = publisher.info
        self.wake(info.node)
        sample = Sample(self.now_ns, info.topic, info.type_name, cdr, info.qos, info.node)
        if info.qos.durability == "transient_local":
            publisher.kept.append(sample)
        self._show(sample)
        for subscription in self._topics.receivers(info):
            self._deliver(sample, subscription)

    def call_at(self, due_ns: int, action: Callable[[], None], *, node: int, entity: int) -> Alarm:
        """Schedule `action` at robot time `due_ns`, in the order of events."""
        return self._clock.call_at(due_ns, action, node=node, entity=entity)

    def advance(self) -> bool:
        """Run the next event; False if none is left before the end, and `ended` from then on."""
        due_ns = self._clock.next_due_ns()
        at_end = self.end_ns is not None and (due_ns is None or due_ns > self.end_ns)
        target_ns = self.end_ns if at_end else due_ns
        if target_ns is None:
            return False
        if self.pace is not None and not self.pace(target_ns):
            return True  # it waited a moment, in which much may have come: look again
        alarm = None if at_end else self._clock.pop()
        self._move_to(target_ns)
        self.ended = at_end
        if alarm is not None:
            alarm.action()
        return alarm is not None

    def next_due_ns(self) -> int | None:
        """Return the time of the next event, [ns]; None if there is none."""
        return self._clock.next_due_ns()

    @property
    def pending(self) -> int:
        """The number of events to come."""
        return len(self._clock)

    def rest(self, node: int) -> None:
        """Leave a node and its endpoints out of the lists, until it wakes or publishes."""
        self._resting.add(node)

    def wake(self, node: int) -> None:
        """List a node and its endpoints again."""
        self._resting.discard(node)

    def nodes(self) -> list[NodeInfo]:
        """List the nodes in their start order."""
        return [node for node in self._nodes.values() if node.id not in self._resting]

    def endpoints(self) -> list[EndpointInfo]:
        """List the publishers and subscriptions in the order of their making."""
        return [info for info in self._topics.endpoints() if info.node not in self._resting]

    def endpoints_on(self, topic: str) -> list[EndpointInfo]:
        """List the publishers and subscriptions of a topic in the order of their making."""
        return [info for info in self._topics.endpoints_on(topic) if info.node not in self._resting]

    def apart(self, publisher: EndpointInfo, subscription: EndpointInfo) -> str | None:
        """Return the policy of QoS that keeps a pair of a topic apart; None if messages pass."""
        return incompatible(publisher.qos, subscription.qos)

    def tap(self, listener: Callable[[Sample], None], wanted: Wanted | None = None) -> Callable[[], None]:
        """Call `listener` with every sample on a topic as it is published; returns what ends that.

        As in `ros2 bag record`, requests and responses of services are not among them. `wanted` names the
        topics that a robot has to send for it; None means all.
        """
        tap = (listener, wanted)
        self._taps.append(tap)
        return lambda: self._taps.remove(tap)

    @property
    def is_tapped(self) -> bool:
        """True while viewers or recordings see what is published."""
        return bool(self._taps)

    def about_link(self) -> list[tuple[str, object]]:
        """Return the state of the link to a robot, as rows of `ros2 doctor`; none without a link."""
        return []

    def close(self) -> None:
        """End the link to a robot, if there is one."""

    def watch_time(self, listener: Callable[[int], None]) -> Callable[[], None]:
        """Call `listener(now_ns)` whenever robot time moves; returns a function that ends that."""
        self._watchers.append(listener)
        return lambda: self._watchers.remove(listener)

    def latched(self) -> list[Sample]:
        """List the samples that TRANSIENT_LOCAL publishers keep for late subscriptions, oldest first."""
        kept = [sample for p in self._topics.publishers.values() for sample in p.kept]
        return sorted(kept, key=lambda sample: sample.stamp_ns)

    def _show(self, sample: Sample) -> None:
        for listener, _ in tuple(self._taps) if sample.topic.startswith("/") else ():
            listener(sample)

    def _move_to(self, now_ns: int) -> None:
        if now_ns > self._clock.now_ns:
            self._clock.now_ns = now_ns
            for watcher in tuple(self._watchers):
                watcher(now_ns)

    def _deliver(self, sample: Sample, subscription: Subscription) -> None:
        info = subscription.info

        def arrive() -> None:
            if info.id in self._topics.subscriptions:
                subscription.on_message(sample.cdr, sample.stamp_ns, self.now_ns)

        due_ns = self.now_ns + self.delay_ns
        self._clock.call_at(due_ns, arrive, node=info.node, entity=subscription.entity)


@dataclass
class NodesOfProgram:
    """The ids of the nodes that one program has in the graph: they leave it when the program ends."""

    ids: set[int] = field(default_factory=set)


class _ProgramName(threading.local):
    name = ""


program = _ProgramName()  # which of the programs that share a graph the calling thread belongs to
_current = Graph()


def current_graph() -> Graph:
    """Return the graph that the stand-in talks to."""
    return _current


def set_graph(graph: Graph) -> None:
    """Replace the current graph."""
    global _current
    _current = graph


@contextmanager
def use_graph(graph: Graph) -> Iterator[Graph]:
    """Use another graph as the current one for the length of a `with` block."""
    before = _current
    set_graph(graph)
    try:
        yield graph
    finally:
        set_graph(before)
