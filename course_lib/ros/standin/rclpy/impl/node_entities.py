"""The part of Node that creates publishers, subscriptions, timers and so on."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, Literal, TypeVar, cast

from course_lib.ros.messages import RosMessage, type_name
from course_lib.ros.mistakes import Mistake, mark
from rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.client import Client
from rclpy.clock import Clock, ROSClock
from rclpy.constants import S_TO_NS
from rclpy.event_handler import Deadline, EventCallbacks, PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.impl import node_graph
from rclpy.impl.endpoint import Endpoint, TopicEnd, require_type
from rclpy.impl.graph_queries import to_qos
from rclpy.impl.node_handle import GuardCondition, NodeHandle
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, qos_profile_services_default
from rclpy.qos_overriding_options import Declares, QoSOverridingOptions, overridden
from rclpy.service import Service
from rclpy.subscription import MessageInfo, Subscription
from rclpy.timer import Rate, Timer

MsgT = TypeVar("MsgT", bound=RosMessage)
OnMessage = Callable[[MsgT], object] | Callable[[MsgT, MessageInfo], object] | Callable[[bytes], object]


class Node(node_graph.Node):
    """The part of Node that creates entities; it has the name Node for the sake of Python's errors."""

    def __init__(self, handle: NodeHandle) -> None:
        super().__init__(handle)
        self._clock = ROSClock()
        self._created: list[Any] = []
        self._default_callback_group = MutuallyExclusiveCallbackGroup()
        self._rate_group = ReentrantCallbackGroup()

    @property
    def default_callback_group(self) -> CallbackGroup:
        """The group of all callbacks that are given no other."""
        return self._default_callback_group

    publishers = property(lambda self: self._all(Publisher), doc="Its publishers.")
    subscriptions = property(lambda self: self._all(Subscription), doc="Its subscriptions.")
    clients = property(lambda self: self._all(Client), doc="Its clients.")
    services = property(lambda self: self._all(Service), doc="Its services.")
    timers = property(lambda self: self._all(Timer), doc="Its timers.")
    guards = property(lambda self: self._all(GuardCondition), doc="Its guard conditions.")

    def create_publisher(
        self,
        msg_type: type[MsgT],
        topic: str,
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: PublisherEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        publisher_class: type[Publisher[Any]] = Publisher,
    ) -> Publisher[MsgT]:
        """Create a publisher.

        Args:
            msg_type: The class of its messages.
            topic: Its topic: `x` is in the node's namespace, `~/x` under the node's name, `/x` is absolute.
            qos_profile: Its quality of service, or only how many messages are kept.
            callback_group: The group of `event_callbacks`.
            event_callbacks: Its events, like subscriptions that come and go.
            qos_overriding_options: The policies that parameters override.
            publisher_class: Its class.
        """
        group = callback_group or self.default_callback_group
        node, full_topic = self.handle, self.resolve_topic_name(topic)
        require_type(msg_type, "message")
        profile = self._profile("publisher", full_topic, qos_profile, qos_overriding_options)
        added = node.graph.add_publisher(node.id, full_topic, type_name(msg_type), to_qos(profile, "pub"))
        publisher = publisher_class(Endpoint(node, added, full_topic), msg_type, topic, profile)
        self._keep(publisher, event_callbacks or PublisherEventCallbacks(), group)
        return publisher

    def create_subscription(
        self,
        msg_type: type[MsgT],
        topic: str,
        callback: "OnMessage[MsgT]",
        qos_profile: QoSProfile | int,
        *,
        callback_group: CallbackGroup | None = None,
        event_callbacks: SubscriptionEventCallbacks | None = None,
        qos_overriding_options: QoSOverridingOptions | None = None,
        raw: bool = False,
    ) -> Subscription[MsgT]:
        """Create a subscription.

        Args:
            msg_type: The class of its messages.
            topic: Its topic: `x` is in the node's namespace, `~/x` under the node's name, `/x` is absolute.
            callback: Called with each message, or with each message and its MessageInfo; may be a coroutine.
            qos_profile: Its quality of service, or only how many messages wait at most.
            callback_group: The group, which decides which callbacks may run at the same time.
            event_callbacks: Its events, like publishers that come and go.
            qos_overriding_options: The policies that parameters override.
            raw: Whether the callback gets the serialised bytes.
        """
        group, full_topic = callback_group or self.default_callback_group, self.resolve_topic_name(topic)
        require_type(msg_type, "message")
        profile = self._profile("subscription", full_topic, qos_profile, qos_overriding_options)
        subscription = Subscription(self.handle, msg_type, topic, full_topic, callback, group, profile, raw)
        self._keep(subscription, event_callbacks or SubscriptionEventCallbacks(), group)
        return subscription

    def create_client(
        self,
        srv_type: Any,
        srv_name: str,
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Client:
        """Create a client of the service `srv_name`; its responses are taken by the rules of the group."""
        full_name, group = self._service(srv_type, srv_name), callback_group or self.default_callback_group
        client = Client(self.handle, group, srv_type, srv_name, full_name, qos_profile)
        self._created.append(client)
        return client

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        *,
        qos_profile: QoSProfile = qos_profile_services_default,
        callback_group: CallbackGroup | None = None,
    ) -> Service:
        """Create a service; `callback(request, response)`, or a coroutine, returns the filled response."""
        full_name, group = self._service(srv_type, srv_name), callback_group or self.default_callback_group
        service = Service(callback, self.handle, group, srv_type, srv_name, full_name, qos_profile)
        self._created.append(service)
        return service

    def create_timer(
        self,
        timer_period_sec: float,
        callback: Callable[[], object] | None,
        callback_group: CallbackGroup | None = None,
        clock: Clock | None = None,
        autostart: bool = True,
    ) -> Timer:
        """Create a timer that calls back every `timer_period_sec` [s], first after one period."""
        try:
            period_ns = int(float(timer_period_sec) * S_TO_NS)
        except (TypeError, ValueError) as error:
            mark(error, Mistake.PERIOD)
            raise
        group = callback_group or self.default_callback_group
        timer = Timer(self.handle, callback, group, period_ns, clock or self._clock, autostart=autostart)
        self._created.append(timer)
        return timer

    def create_guard_condition(
        self, callback: Callable[[], object], callback_group: CallbackGroup | None = None
    ) -> GuardCondition:
        """Create a guard condition, whose callback runs after each `trigger()`."""
        guard = GuardCondition(self.handle, callback, callback_group or self.default_callback_group)
        self._created.append(guard)
        return guard

    def create_rate(self, frequency: float, clock: Clock | None = None) -> Rate:
        """Create a rate for loops at a frequency [Hz]; another thread must spin the node meanwhile."""
        if frequency <= 0:
            raise ValueError("frequency must be > 0")
        return Rate(
            self.create_timer(1.0 / frequency, None, self._rate_group, clock), context=self.handle.context
        )

    def add_waitable(self, waitable: Any) -> None:
        """Add an entity made elsewhere; it is destroyed with the node."""
        self._created.append(waitable)

    def destroy_publisher(self, created: Any) -> bool:
        """Destroy an entity; False if the node has not created it, or it is destroyed already."""
        if created not in self._created:
            return False
        self._created.remove(created)
        created.destroy()
        return True

    destroy_subscription = destroy_client = destroy_service = destroy_timer = destroy_publisher
    destroy_guard_condition = destroy_publisher

    def destroy_rate(self, rate: Rate) -> bool:
        """Destroy a rate; the thread that sleeps in it wakes up."""
        rate.destroy()
        return self.destroy_timer(rate.timer)

    def _keep(self, end: TopicEnd[Any], events: EventCallbacks, group: CallbackGroup) -> None:
        self._created.append(end)
        told = events.bind(self.handle, end.topic, group)
        limit_ns = to_qos(end.qos_profile, "pub").deadline_ns
        if limit_ns is not None and "deadline" in told.tell:
            end.deadline = Deadline(self.handle, limit_ns, partial(told.count, "deadline"))
        end.handle.watch(told)

    def _profile(
        self,
        kind: Literal["publisher", "subscription"],
        topic: str,
        qos_profile: QoSProfile | int,
        options: QoSOverridingOptions | None,
    ) -> QoSProfile:
        return overridden(cast("Declares", self), kind, topic, _to_profile(qos_profile), options)

    def _all(self, kind: type) -> Iterator[Any]:
        return (created for created in self._created if isinstance(created, kind))

    def _service(self, srv_type: Any, srv_name: str) -> str:
        """Check a service's type; returns its fully resolved name."""
        require_type(srv_type, "service")
        return self.resolve_service_name(srv_name)


def _to_profile(qos_profile: QoSProfile | int) -> QoSProfile:
    if isinstance(qos_profile, QoSProfile):
        return qos_profile
    if not isinstance(qos_profile, int):
        raise TypeError(f"Expected QoSProfile or int, but received {type(qos_profile)!r}")
    if qos_profile < 0:
        raise ValueError("history depth must be greater than or equal to zero")
    return QoSProfile(depth=qos_profile)
