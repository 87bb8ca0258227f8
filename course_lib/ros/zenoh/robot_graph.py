"""The graph of a kit that is linked to a robot: on the wall clock, with the robot's nodes beside its own."""

from _queue import Empty

from course_lib.ros import wall
from course_lib.ros.graph import Graph
from course_lib.ros.messages.hashes import is_known
from course_lib.ros.qos import Qos
from course_lib.ros.topics import SERVICE_TOPICS, EndpointInfo, OnMessage, Sample
from course_lib.ros.zenoh import explain
from course_lib.ros.zenoh.ears import Ears
from course_lib.ros.zenoh.inbox import Packet
from course_lib.ros.zenoh.link import Declared, RobotLink
from course_lib.ros.zenoh.login import Wheel
from course_lib.ros.zenoh.neighbours import Neighbours
from course_lib.ros.zenoh.sending import Allowed, HeldBack, Sending, Tell
from course_lib.ros.zenoh.services import Services
from course_lib.ros.zenoh.tokens import Entity

SLICE = 0.02  # [s] an interrupt is noticed within
LAST_SECONDS = 3.0  # [s] that Python's end waits for a link; a kernel that restarts is killed after 5
LOOK_NS = 200_000_000  # [ns] between two looks at the link and at what taps want
TAPS = "_course_lib"  # the node that listens for displays and recordings; ROS hides the name
AT_ONCE = 100  # arrivals that are taken before an event that is due


def _ignore(cdr: bytes, source_ns: int, received_ns: int) -> None:
    """Do nothing: taps see every sample."""


class RobotGraph(Graph):
    """Robot time is the wall clock, and nothing is ever the last event while the link is open.

    Args:
        link: The session; the graph closes it.
        allowed: The names that may go out.
        tell: Prints a line on the link.
        notebook: A kernel's own graph.
    """

    keeps_wall_time = True

    def __init__(self, link: RobotLink, allowed: Allowed, tell: Tell, *, notebook: bool = False) -> None:
        super().__init__(start_ns=wall.time_ns(), delay_ns=0, notebook=notebook)
        self.link = link
        self.held_back = HeldBack(tell, notebook=notebook)
        self._allowed, self._tell = allowed, tell
        self._told = set[str]()
        self._own: dict[int, tuple[Entity, Declared]] = {}  # our nodes
        self._announced: dict[int, Declared] = {}  # our subscriptions
        self._ears = Ears(link, self._arrive)
        self._sending = Sending()
        self._services = Services(link, self._bring)
        self._others = Neighbours(self, self._topics, self._meet)
        self._for_taps: dict[tuple[str, str], int] = {}  # endpoints of the node TAPS
        self._tap_node: int | None = None
        self._looked_ns, self._up, self._down_since = 0, True, 0.0
        self._wheel = Wheel(link.login, tell)
        link.watch(self._others.change)
        if link.login.name:
            link.watch_gateway(self._wheel.change)

    @property
    def now_ns(self) -> int:
        """Robot time, [ns]: the wall clock, which never goes back."""
        return self._clock.now_ns if self.ended else max(self._clock.now_ns, wall.time_ns())

    def advance(self) -> bool:
        """Run the actions that have arrived and the event that is due; else wait a moment for either."""
        due_ns = self._clock.next_due_ns()
        if self.end_ns is not None and self.now_ns >= self.end_ns and (due_ns or self.end_ns) >= self.end_ns:
            self.ended = True
        if self.ended:
            return False
        left = SLICE if due_ns is None else (due_ns - self.now_ns) * 1e-9
        try:
            self._take(min(max(left, 0.0), SLICE))
            self._look()
            self._move_to(self.now_ns)
            due_ns = self._clock.next_due_ns()
            if due_ns is not None and due_ns <= self._clock.now_ns:
                self._clock.pop().action()
        except KeyboardInterrupt:
            self._sending.stop()
            raise
        return True

    def add_node(self, name: str, namespace: str) -> int:
        """Add a node and announce it."""
        node = super().add_node(name, namespace)
        entity = self.link.node(name, namespace)
        self._own[node] = entity, self.link.announce(entity)
        return node

    def remove_node(self, node: int) -> None:
        """Remove a node with its endpoints."""
        for info in self._topics.endpoints():
            if info.node == node:
                self.remove_endpoint(info.id)
        super().remove_node(node)
        if node in self._own:
            self._own.pop(node)[1].withdraw()

    def add_publisher(self, node: int, topic: str, type_name: str, qos: Qos) -> int:
        """Add a publisher; it is on the network if its topic may be sent."""
        endpoint = super().add_publisher(node, topic, type_name, qos)
        info = self._topics.publishers[endpoint].info
        entity = self._own[node][0]
        if info.service is None:
            if self._allowed.topic(topic):
                outward = self.link.login.outward(topic)
                outlet = self.link.publisher(self.link.endpoint(entity, "MP", outward, type_name, qos))
                self._sending.add(endpoint, type_name, outlet)
                self._compare(topic)
        elif _asks(info) and self._allowed.service(info.service[0]):
            self._services.add_client(entity, info)
        return endpoint

    def add_subscription(
        self, node: int, entity: int, topic: str, type_name: str, qos: Qos, on_message: OnMessage
    ) -> int:
        """Add a subscription; the robot sends its topic from now on."""
        endpoint = super().add_subscription(node, entity, topic, type_name, qos, on_message)
        info, own = self._topics.subscriptions[endpoint].info, self._own[node][0]
        if info.service is None:
            self._ears.listen(endpoint, topic, type_name, qos)  # first: who sees the token may publish
            announced = self.link.endpoint(own, "MS", topic, type_name, qos)
            self._announced[endpoint] = self.link.announce(announced)
            self._compare(topic)
        elif info.is_service and self._allowed.service(info.service[0]):
            self._services.add_server(own, info)
        return endpoint

    def remove_endpoint(self, endpoint: int) -> None:
        """Remove an endpoint, here and on the network."""
        super().remove_endpoint(endpoint)
        self._sending.remove(endpoint)
        self._services.remove(endpoint)
        self._ears.leave(endpoint)
        if endpoint in self._announced:
            self._announced.pop(endpoint).withdraw()

    def apart(self, publisher: EndpointInfo, subscription: EndpointInfo) -> str | None:
        """Return the policy that keeps two ends of the kit apart; over the link Zenoh lets all pass."""
        return None if self._is_over_link(publisher, subscription) else super().apart(publisher, subscription)

    def publish(self, endpoint: int, cdr: bytes) -> None:
        """Publish here, and on the network if that is allowed."""
        super().publish(endpoint, cdr)
        info = self._topics.publishers[endpoint].info
        if info.service is None:
            if self._sending.put(endpoint, cdr):
                self._wheel.sent(info.topic)
            else:
                self.held_back.note(info.topic, "--send")
        elif not _asks(info):
            self._services.answer(cdr)
        elif self._others.servers[info.service[0]] > 0 and not self._services.ask(info, cdr):
            self.held_back.note(info.service[0], "--call")

    def about_link(self) -> list[tuple[str, object]]:
        """Return the state of the link: the router, what goes out, the clocks, and the rates of topics."""
        state = "connected" if self._up else "lost"
        held = (f"{count} on {name}" for name, count in sorted(self.held_back.counts.items()))
        skew = self._skew()
        return [
            ("router", f"{self.link.address}, {state}"),
            ("domain", self.link.domain),
            ("nodes", len(self._others)),
            *self._allowed.rows(),
            *self._wheel.rows(),
            ("held back", ", ".join(held) or "nothing"),
            ("robot's clock", explain.NO_SKEW if skew is None else f"{skew:+.3f} s from this computer's"),
            *(ear.row() for ear in self._ears),
        ]

    def close(self) -> None:
        """Stop what is driven and end the link, once a robot that moves has its stop."""
        self._ears.close()
        self._sending.close(self.link.close)
        if self.link.is_open:
            self._tell_once("stop", explain.STOP_IS_DUE)

    def leave(self) -> None:
        """Close at Python's end: wait a moment for a link that is down, if the robot needs its stop."""
        self.close()
        end = wall.monotonic() + LAST_SECONDS
        while self.link.is_open and wall.monotonic() < end:
            wall.sleep(SLICE)
        if self.link.is_open:
            self._tell(explain.NO_STOP)
            self.link.close()

    def _take(self, seconds: float) -> None:
        """Run the actions that Zenoh's threads have queued; wait so long for the first, [s]."""
        arrived = self.link.arrived
        try:
            action = arrived.get(timeout=seconds) if seconds else arrived.get_nowait()
            for _ in range(AT_ONCE):
                action()
                action = arrived.get_nowait()
            action()
        except Empty:
            return

    def _arrive(self, topic: str, type_name: str, arrival: Packet) -> None:
        """Show and deliver a message by Zenoh's rule: to all of its topic and type, whatever their QoS."""
        publisher = self._others.publisher(arrival.gid)
        qos, node = (publisher.info.qos, publisher.info.node) if publisher else (Qos(), 0)
        sample = Sample(self.now_ns, topic, type_name, arrival.cdr, qos, node)
        if publisher is not None and qos.durability == "transient_local":
            publisher.kept.append(sample)
        self._show(sample)
        self._spread(sample)

    def _bring(self, topic: str, type_name: str, data: bytes) -> None:
        self._spread(Sample(self.now_ns, topic, type_name, data, Qos(), 0))

    def _spread(self, sample: Sample) -> None:
        for subscription in self._topics.listening(sample.topic, sample.type_name):
            self._deliver(sample, subscription)

    def _meet(self, entity: Entity) -> None:
        self._tell_once(entity.type_name, explain.about_type(entity))
        if entity.kind in ("MP", "MS"):
            self._compare(entity.topic)

    def _compare(self, topic: str) -> None:
        """Warn of pairs over the link that DDS would keep apart."""
        ends = self._topics.endpoints_on(topic)
        for publisher in (info for info in ends if info.kind == "pub"):
            for heard in (info for info in ends if info.kind == "sub"):
                if self._is_over_link(publisher, heard):
                    self._tell_once(f"qos {topic}", explain.about_qos(publisher, heard))

    def _is_over_link(self, publisher: EndpointInfo, subscription: EndpointInfo) -> bool:
        return (publisher.node in self._own) != (subscription.node in self._own)

    def _look(self) -> None:
        """Now and then: subscribe to what taps want, and tell what is wrong with the link."""
        if self.now_ns - self._looked_ns < LOOK_NS or not self.link.is_open:
            return
        self._looked_ns = self.now_ns
        self._follow_taps()
        self._watch_router()
        if self.link.old_attachments:
            self._tell_once("old rmw", explain.about_old_rmw(self.link.old_attachments))
        self._tell_once("clock", explain.about_clock(self._skew() or 0.0))
        for ear in self._ears:
            self._tell_once(f"slow {ear.topic}", ear.complaint())

    def _follow_taps(self) -> None:
        """Listen for displays and recordings to the topics that they want, with the QoS that is offered."""
        offered = {(info.topic, info.type_name): info.qos for info in self._others.published()}
        names = {topic for topic, _ in offered} if any(wanted is None for _, wanted in self._taps) else set()
        names |= {name for _, wanted in self._taps if wanted is not None for name in wanted()}
        needed = {one for one in offered if one[0] in names and is_known(one[1])}
        for gone in self._for_taps.keys() - needed:
            self.remove_endpoint(self._for_taps.pop(gone))
        if needed and self._tap_node is None:
            self._tap_node = self.add_node(TAPS, "/")
        for new in sorted(needed - self._for_taps.keys()):
            self._for_taps[new] = self.add_subscription(self._tap_node or 0, 0, *new, offered[new], _ignore)

    def _watch_router(self) -> None:
        up, address = self.link.is_up(), self.link.address
        if self._up and not up:
            self._down_since = wall.monotonic()
            self._tell(
                f"The link to {address} is lost. It comes back by itself when the router is there again."
            )
            for ear in self._ears:
                ear.traffic.forget_sequences()
        elif up and not self._up:
            self._tell(f"The link to {address} is back after {wall.monotonic() - self._down_since:.1f} s.")
        self._up = up

    def _skew(self) -> float | None:
        """Return how far the robot's clock is ahead of ours, [s], less the way; latched messages are old."""
        lags = [ear.traffic.lag_ns for ear in self._ears if not ear.kept]
        known = [lag for lag in lags if lag is not None]
        return -min(known) * 1e-9 if known else None

    def _tell_once(self, about: str, line: str) -> None:
        if line and about not in self._told:
            self._told.add(about)
            self._tell(line)


def _asks(info: EndpointInfo) -> bool:
    """Return whether an endpoint is on the topic of a service's requests."""
    return info.topic.startswith(f"{SERVICE_TOPICS[0][0]}/")
