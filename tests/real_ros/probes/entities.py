# mypy: ignore-errors
"""Subscriptions, publishers, events of QoS, the order of destruction, and contexts."""

import threading
import time
from typing import Any

import rclpy
from probing import Fibonacci, lines, main, outcome
from rclpy.action import ActionClient, ActionServer
from rclpy.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.context import Context
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.parameter_event_handler import ParameterEventHandler
from rclpy.qos import (
    DurabilityPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_sensor_data,
)
from rclpy.serialization import serialize_message
from std_msgs.msg import Float64MultiArray, Int32, String, UInt8MultiArray
from std_srvs.srv import Trigger


def _spin(seconds: Any, *nodes: Any) -> None:
    executor = SingleThreadedExecutor()
    for node in nodes:
        executor.add_node(node)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.02)
    for node in nodes:
        executor.remove_node(node)
    executor.shutdown()


def _destroy(*steps: Any) -> Any:
    """Run steps on a node with one entity of each kind. Return the results or exceptions."""
    node = Node("n")
    parts = {
        "node": node,
        "publisher": node.create_publisher(Int32, "t", 1),
        "subscription": node.create_subscription(Int32, "t", print, 1),
        "client": node.create_client(Trigger, "s"),
        "service": node.create_service(Trigger, "s", print),
        "timer": node.create_timer(1.0, print),
        "guard": node.create_guard_condition(print),
        "rate": node.create_rate(1.0),
    }
    return [outcome(step, parts) for step in steps]


def _gone(kind: Any, *uses: Any) -> Any:
    destroy = lambda p: getattr(p["node"], f"destroy_{kind}")(p[kind])  # noqa: E731
    return _destroy(destroy, destroy, *uses)


lines(
    "gone",
    publisher=lambda: _gone(
        "publisher",
        lambda p: p["publisher"].publish(Int32()),
        lambda p: p["publisher"].topic_name,
        lambda p: p["publisher"].topic,
        lambda p: p["publisher"].get_subscription_count(),
        lambda p: len(list(p["node"].publishers)),
        lambda p: p["publisher"].assert_liveliness(),
        lambda p: p["publisher"].destroy(),
    ),
    subscription=lambda: _gone(
        "subscription",
        lambda p: p["subscription"].topic_name,
        lambda p: p["subscription"].get_publisher_count(),
        lambda p: len(list(p["node"].subscriptions)),
        lambda p: p["subscription"].destroy(),
    ),
    client=lambda: _gone(
        "client",
        lambda p: p["client"].service_is_ready(),
        lambda p: p["client"].call_async(Trigger.Request()),
        lambda p: p["client"].srv_name,
        lambda p: p["client"].service_name,
        lambda p: p["client"].wait_for_service(timeout_sec=0.1),
        lambda p: len(list(p["node"].clients)),
    ),
    service=lambda: _gone(
        "service",
        lambda p: p["service"].srv_name,
        lambda p: p["service"].service_name,
        lambda p: p["service"].send_response(Trigger.Response(), None),
        lambda p: len(list(p["node"].services)),
    ),
    timer=lambda: _gone(
        "timer",
        lambda p: p["timer"].cancel(),
        lambda p: p["timer"].is_canceled(),
        lambda p: p["timer"].timer_period_ns,
        lambda p: p["timer"].time_until_next_call(),
        lambda p: len(list(p["node"].timers)),
    ),
    guard=lambda: _destroy(
        lambda p: p["node"].destroy_guard_condition(p["guard"]),
        lambda p: p["node"].destroy_guard_condition(p["guard"]),
        lambda p: p["guard"].trigger(),
        lambda p: len(list(p["node"].guards)),
    ),
    rate=lambda: _gone("rate", lambda p: p["rate"].sleep(), lambda p: p["rate"].destroy()),
    wrong_kind=lambda: _destroy(
        lambda p: p["node"].destroy_publisher(p["subscription"]),
        lambda p: p["node"].destroy_subscription(p["publisher"]),
        lambda p: p["node"].destroy_timer(p["client"]),
        lambda p: p["node"].destroy_client(p["service"]),
        lambda p: p["node"].destroy_service(None),
        lambda p: p["node"].destroy_publisher("t"),
    ),
    node_then_parts=lambda: _destroy(
        lambda p: p["node"].destroy_node(),
        lambda p: p["node"].destroy_node(),
        lambda p: p["node"].destroy_publisher(p["publisher"]),
        lambda p: p["publisher"].publish(Int32()),
        lambda p: p["timer"].cancel(),
        lambda p: p["client"].call_async(Trigger.Request()),
        lambda p: p["guard"].trigger(),
        lambda p: [len(list(p["node"].publishers)), len(list(p["node"].timers))],
        lambda p: p["node"].get_logger().name,
        lambda p: p["node"].get_parameter("use_sim_time").value,
        lambda p: p["node"].has_parameter("use_sim_time"),
        lambda p: p["node"].declare_parameter("a", 1).value,
        lambda p: p["node"].context.ok(),
        lambda p: p["node"].executor,
        lambda p: p["node"].default_callback_group is not None,
    ),
    shutdown_then_parts=lambda: _destroy(
        lambda p: rclpy.shutdown(),
        lambda p: p["publisher"].publish(Int32()),
        lambda p: p["publisher"].get_subscription_count(),
        lambda p: p["publisher"].topic_name,
        lambda p: p["client"].service_is_ready(),
        lambda p: p["client"].call_async(Trigger.Request()),
        lambda p: p["timer"].cancel(),
        lambda p: p["timer"].is_canceled(),
        lambda p: p["timer"].reset(),
        lambda p: p["guard"].trigger(),
        lambda p: p["node"].get_name(),
        lambda p: p["node"].get_topic_names_and_types(),
        lambda p: p["node"].count_publishers("/t"),
        lambda p: p["node"].get_clock().now().nanoseconds > 0,
        lambda p: p["node"].create_client(Trigger, "x"),
        lambda p: p["node"].create_service(Trigger, "x", print),
        lambda p: p["node"].create_guard_condition(print),
        lambda p: p["node"].create_rate(1.0),
        lambda p: p["node"].declare_parameter("a", 1).value,
        lambda p: p["node"].destroy_publisher(p["publisher"]),
        lambda p: p["node"].destroy_timer(p["timer"]),
        lambda p: p["node"].destroy_node(),
        lambda p: p["node"].destroy_node(),
    ),
    node_in_with=lambda: outcome(lambda: _with_node()),
    publisher_in_callback=lambda: _destroyed_in_callback("publisher"),
    subscription_in_callback=lambda: _destroyed_in_callback("subscription"),
    timer_in_callback=lambda: _destroyed_in_callback("timer"),
)


def _with_node() -> Any:
    with Node("n") as node:
        found = node.get_name()
    return [found, outcome(lambda: node.get_name())]


def _destroyed_in_callback(kind: Any) -> Any:
    node, seen = Node("n"), []
    publisher = node.create_publisher(Int32, "t", 5)

    def take(message: Any) -> None:
        seen.append(message.data)
        part = {"publisher": publisher, "subscription": subscription, "timer": timer}[kind]
        getattr(node, f"destroy_{kind}")(part)

    subscription = node.create_subscription(Int32, "t", take, 5)

    def send() -> None:
        if len(seen) < 3:
            publisher.publish(Int32(data=7))

    timer = node.create_timer(0.05, send)
    found = outcome(_spin, 0.6, node)
    return [found, len(seen) if kind != "timer" else len(seen) <= 2]


# Contexts.
def _contexts(*steps: Any) -> Any:
    context = Context()
    return [outcome(step, context) for step in steps]


lines(
    "context",
    new=lambda: _contexts(
        lambda c: c.ok(), lambda c: c.shutdown(), lambda c: c.try_shutdown(), lambda c: Node("a", context=c)
    ),
    own=lambda: _contexts(
        lambda c: rclpy.init(context=c) is None or True,
        lambda c: c.ok(),
        lambda c: rclpy.ok(context=c),
        lambda c: Node("a", context=c).get_name(),
        lambda c: rclpy.init(context=c),
        lambda c: rclpy.shutdown(context=c),
        lambda c: c.ok(),
        lambda c: rclpy.ok(),
        lambda c: rclpy.shutdown(context=c),
        lambda c: rclpy.try_shutdown(context=c),
        lambda c: rclpy.init(context=c),
    ),
    in_with=lambda: _contexts(lambda c: _with_context(c), lambda c: c.ok()),
    other_executor=lambda: _contexts(
        lambda c: c.init(),
        lambda c: SingleThreadedExecutor(context=c).context is c,
        lambda c: SingleThreadedExecutor().add_node(Node("a", context=c)),
        lambda c: c.shutdown(),
    ),
    init_args=lambda: _contexts(
        lambda c: c.init(args=["--ros-args", "-r", "__node:=other"]),
        lambda c: Node("a", context=c).get_name(),
    ),
    init_number=lambda: _contexts(lambda c: c.init(args=5)),
    init_text=lambda: _contexts(lambda c: c.init(args="a"), lambda c: c.ok()),
    domain=lambda: _contexts(lambda c: c.init(domain_id=-1), lambda c: c.ok()),
    domain_text=lambda: _contexts(lambda c: c.init(domain_id="a")),
    domain_big=lambda: _contexts(lambda c: c.init(domain_id=5), lambda c: c.ok()),
    on_shutdown=lambda: _on_shutdown(),
    on_shutdown_late=lambda: _on_shutdown_late(),
    on_shutdown_raises=lambda: _on_shutdown_raises(),
    twice=lambda: [outcome(rclpy.init), outcome(rclpy.shutdown), outcome(rclpy.shutdown)],
    again=lambda: [
        outcome(rclpy.shutdown),
        outcome(lambda: rclpy.init(args=[]) and None),
        outcome(rclpy.ok),
        Node("a").get_name(),
    ],
    try_twice=lambda: [outcome(rclpy.try_shutdown), outcome(rclpy.try_shutdown), outcome(rclpy.ok)],
    shutdown_text=lambda: outcome(lambda: rclpy.shutdown("now")),
    shutdown_wrong=lambda: outcome(lambda: rclpy.shutdown(context=5)),
    no_node=lambda: [outcome(rclpy.shutdown), outcome(lambda: Node("a"))],
    default=lambda: [rclpy.get_default_context() is Node("a").context, rclpy.get_default_context().ok()],
    in_thread=lambda: _shutdown_in_thread(),
    spin_nothing=lambda: [outcome(lambda: rclpy.spin(None)), outcome(lambda: rclpy.spin("n"))],
    spin_once_text=lambda: outcome(lambda: rclpy.spin_once(Node("a"), timeout_sec="1")),
    spin_once_positional=lambda: outcome(lambda: rclpy.spin_once(Node("a"), 1.0)),
    create_node=lambda: [rclpy.create_node("a").get_name(), outcome(lambda: rclpy.create_node())],
    create_node_options=lambda: rclpy.create_node("a", namespace="b").get_fully_qualified_name(),
    create_node_wrong=lambda: outcome(lambda: rclpy.create_node("a", names="b")),
    rmw=lambda: type(rclpy.get_rmw_implementation_identifier()).__name__,
)


def _with_context(context: Any) -> Any:
    with context as inner:
        return [inner is context, context.ok()]


def _on_shutdown() -> Any:
    calls = []
    rclpy.get_default_context().on_shutdown(lambda: calls.append("a"))
    rclpy.get_default_context().on_shutdown(lambda: calls.append("b"))
    rclpy.shutdown()
    return calls


def _on_shutdown_late() -> Any:
    calls, context = [], rclpy.get_default_context()
    rclpy.shutdown()
    return [outcome(context.on_shutdown, lambda: calls.append("a")), calls]


def _on_shutdown_raises() -> Any:
    calls, context = [], rclpy.get_default_context()
    context.on_shutdown(lambda: 1 / 0)
    context.on_shutdown(lambda: calls.append("b"))
    return [outcome(rclpy.shutdown), calls, context.ok()]


def _shutdown_in_thread() -> Any:
    node = Node("n")
    threading.Timer(0.3, rclpy.shutdown).start()
    return [outcome(rclpy.spin, node), outcome(rclpy.ok)]


# Events of QoS.
_COUNTS = ("total_count", "total_count_change", "current_count", "current_count_change", "last_policy_kind")


def _events(publisher_qos: Any, subscription_qos: Any, **more: Any) -> Any:
    node, seen = Node("n"), []

    def note(name: Any) -> Any:
        return lambda info: seen.append(
            (name, [(key, getattr(info, key)) for key in _COUNTS if hasattr(info, key)])
        )

    publishes = PublisherEventCallbacks(
        incompatible_qos=note("offered"), matched=note("publication"), **more.get("publisher", {})
    )
    takes = SubscriptionEventCallbacks(
        incompatible_qos=note("requested"), matched=note("subscription"), message_lost=note("lost")
    )
    publisher = node.create_publisher(Int32, "t", publisher_qos, event_callbacks=publishes)
    subscription = node.create_subscription(Int32, "t", print, subscription_qos, event_callbacks=takes)
    _spin(0.5, node)
    node.destroy_subscription(subscription)
    _spin(0.4, node)
    return [sorted(map(repr, seen)), len(publisher.event_handlers)]


_BEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
_KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_FAST = QoSProfile(depth=1, deadline=Duration(seconds=1))
_SLOW = QoSProfile(depth=1, deadline=Duration(seconds=2))
_MANUAL = QoSProfile(
    depth=1, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC, liveliness_lease_duration=Duration(seconds=1)
)
lines(
    "event",
    matched=lambda: _events(1, 1),
    reliability=lambda: _events(_BEST, 1),
    durability=lambda: _events(1, _KEPT),
    both=lambda: _events(_BEST, _KEPT),
    deadline=lambda: _events(_SLOW, _FAST),
    deadline_fits=lambda: _events(_FAST, _SLOW),
    liveliness=lambda: _events(1, _MANUAL),
    sensor=lambda: _events(qos_profile_sensor_data, 10),
    to_sensor=lambda: _events(10, qos_profile_sensor_data),
    no_default=lambda: outcome(
        lambda: len(
            Node("n")
            .create_publisher(
                Int32, "t", 1, event_callbacks=PublisherEventCallbacks(use_default_callbacks=False)
            )
            .event_handlers
        )
    ),
    default=lambda: outcome(lambda: len(Node("n").create_subscription(Int32, "t", print, 1).event_handlers)),
    deadline_missed=lambda: _deadline(),
    deadline_callback_wrong=lambda: outcome(lambda: PublisherEventCallbacks(deadline=5)),
    unknown=lambda: outcome(lambda: PublisherEventCallbacks(lost=print)),
)


def _deadline() -> Any:
    node, seen = Node("n"), []
    quick = QoSProfile(depth=1, deadline=Duration(seconds=0.2))
    offered = PublisherEventCallbacks(deadline=lambda info: seen.append(("offered", info.total_count)))
    requested = SubscriptionEventCallbacks(deadline=lambda info: seen.append(("requested", info.total_count)))
    publisher = node.create_publisher(Int32, "t", quick, event_callbacks=offered)
    node.create_subscription(Int32, "t", lambda message: None, quick, event_callbacks=requested)
    _spin(0.3, node)
    publisher.publish(Int32())
    _spin(0.5, node)
    return sorted({name for name, count in seen if count >= 1})


# Callbacks of subscriptions.
def _takes(make: Any, *messages: Any, type_: Any = Int32, qos: Any = 10, **options: Any) -> Any:
    node, seen = Node("n"), []
    publisher = node.create_publisher(type_, "t", qos)
    node.create_subscription(type_, "t", make(seen), qos, **options)
    _spin(0.3, node)
    for message in messages:
        publisher.publish(message)
    found = outcome(_spin, 0.3, node)
    return [found, seen]


class _Callable:
    def __init__(self, seen: Any) -> None:
        self.seen = seen

    def __call__(self, message: Any) -> None:
        self.seen.append(message.data)


async def _nothing() -> None:
    return None


def _coroutine(seen: Any) -> Any:
    async def take(message: Any) -> None:
        await _nothing()
        seen.append(message.data)

    return take


def _with_info(seen: Any) -> Any:
    def take(message: Any, info: Any) -> None:
        seen.append((message.data, sorted(info), info["source_timestamp"] > 0))

    return take


def _with_default(seen: Any) -> Any:
    def take(message: Any, more: Any = 3) -> None:
        seen.append((message.data, type(more).__name__))

    return take


lines(
    "takes",
    lambda_=lambda: _takes(lambda seen: lambda m: seen.append(m.data), Int32(data=1)),
    append=lambda: _takes(lambda seen: seen.append, Int32(data=1)),
    callable=lambda: _takes(_Callable, Int32(data=1)),
    coroutine=lambda: _takes(_coroutine, Int32(data=1), Int32(data=2)),
    info=lambda: _takes(_with_info, Int32(data=1)),
    default=lambda: _takes(_with_default, Int32(data=1)),
    keyword_only=lambda: _takes(lambda seen: lambda m, *, a=1: seen.append((m.data, a)), Int32(data=1)),
    variadic=lambda: _takes(lambda seen: lambda *a: seen.append(len(a)), Int32(data=1)),
    keywords=lambda: _takes(lambda seen: lambda m, **k: seen.append(m.data), Int32(data=1)),
    raw=lambda: _takes(lambda seen: lambda m: seen.append(m), Int32(data=1), raw=True),
    raw_text=lambda: _takes(lambda seen: lambda m: seen.append(m), String(data="ab"), type_=String, raw=True),
    raw_text_three=lambda: _takes(
        lambda seen: lambda m: seen.append(m), String(data="abc"), type_=String, raw=True
    ),
    raw_array=lambda: _takes(
        lambda seen: lambda m: seen.append(m), UInt8MultiArray(data=b"abcde"), type_=UInt8MultiArray, raw=True
    ),
    raw_doubles=lambda: _takes(
        lambda seen: lambda m: seen.append(m),
        Float64MultiArray(data=[1.0]),
        type_=Float64MultiArray,
        raw=True,
    ),
    raw_with_info=lambda: _takes(
        lambda seen: lambda m, i: seen.append((len(m), len(i))), Int32(data=1), raw=True
    ),
    bytes=lambda: _takes(lambda seen: lambda m: seen.append(m.data), serialize_message(Int32(data=4))),
    changed_after=lambda: _changed_after(),
    same_object=lambda: _takes(lambda seen: lambda m: seen.append(m.data), *[Int32(data=3)] * 3),
    depth_one=lambda: _takes(lambda seen: lambda m: seen.append(m.data), *map(_int, range(5)), qos=1),
    raises_first=lambda: _takes(lambda seen: _raise_once(seen), Int32(data=1), Int32(data=2)),
    filter=lambda: outcome(
        lambda: Node("n").create_subscription(Int32, "t", print, 1, content_filter_options=None) is None
    ),
    positional=lambda: outcome(lambda: Node("n").create_subscription(Int32, "t", print)),
    topic_none=lambda: outcome(lambda: Node("n").create_subscription(Int32, None, print, 1)),
    topic_number=lambda: outcome(lambda: Node("n").create_subscription(Int32, 5, print, 1)),
    topic_empty=lambda: outcome(lambda: Node("n").create_subscription(Int32, "", print, 1)),
    topic_slash=lambda: outcome(lambda: Node("n").create_subscription(Int32, "/", print, 1)),
    topic_end=lambda: outcome(lambda: Node("n").create_subscription(Int32, "a/", print, 1)),
    topic_two=lambda: outcome(lambda: Node("n").create_subscription(Int32, "a//b", print, 1)),
    topic_digit=lambda: outcome(lambda: Node("n").create_subscription(Int32, "1a", print, 1)),
    topic_dash=lambda: outcome(lambda: Node("n").create_publisher(Int32, "a-b", 1)),
    topic_private=lambda: Node("n", namespace="x").create_publisher(Int32, "~/a", 1).topic_name,
    topic_braces=lambda: outcome(lambda: Node("n").create_publisher(Int32, "{node}/a", 1).topic_name),
    topic_unknown_braces=lambda: outcome(lambda: Node("n").create_publisher(Int32, "{no}/a", 1).topic_name),
    topic_long=lambda: outcome(lambda: Node("n").create_publisher(Int32, "a" * 300, 1).topic_name).partition(
        ":"
    )[0],
)


def _int(number: Any) -> Any:
    return Int32(data=number)


def _raise_once(seen: Any) -> Any:
    def take(message: Any) -> None:
        seen.append(message.data)
        if len(seen) == 1:
            raise KeyError("a")

    return take


def _changed_after() -> Any:
    node, seen = Node("n"), []
    publisher = node.create_publisher(Int32, "t", 10)
    node.create_subscription(Int32, "t", lambda m: seen.append(m.data), 10)
    _spin(0.3, node)
    message = Int32(data=1)
    publisher.publish(message)
    message.data = 2
    _spin(0.3, node)
    return seen


# Groups.
lines(
    "group",
    default=lambda: type(Node("n").default_callback_group).__name__,
    set_default=lambda: _set_default(),
    of_timer=lambda: _group_of(lambda node, group: node.create_timer(1.0, print, callback_group=group)),
    of_publisher=lambda: _group_of(
        lambda node, group: node.create_publisher(Int32, "t", 1, callback_group=group)
    ),
    of_class=lambda: outcome(
        lambda: Node("n").create_timer(1.0, print, callback_group=MutuallyExclusiveCallbackGroup)
    ),
    of_text=lambda: outcome(lambda: Node("n").create_timer(1.0, print, callback_group="a")),
    has=lambda: _has_entity(),
    reentrant_execute=lambda: ReentrantCallbackGroup().can_execute(None),
    begin=lambda: _begin(),
    base=lambda: outcome(lambda: CallbackGroup().can_execute(None)),
)


def _set_default() -> Any:
    node = Node("n")
    group = ReentrantCallbackGroup()
    node._default_callback_group = group
    return node.create_timer(1.0, print).callback_group is group


def _group_of(make: Any) -> Any:
    node, group = Node("n"), ReentrantCallbackGroup()
    entity = make(node, group)
    return [getattr(entity, "callback_group", None) is group, len(list(group.entities))]


def _has_entity() -> Any:
    node, group = Node("n"), ReentrantCallbackGroup()
    timer, other = node.create_timer(1.0, print, callback_group=group), node.create_timer(1.0, print)
    return [group.has_entity(timer), group.has_entity(other)]


def _begin() -> Any:
    node, group = Node("n"), MutuallyExclusiveCallbackGroup()
    first = node.create_timer(1.0, print, callback_group=group)
    second = node.create_timer(1.0, print, callback_group=group)
    found = [group.beginning_execution(first), group.can_execute(second), group.beginning_execution(second)]
    group.ending_execution(first)
    return [*found, group.can_execute(second)]


# Guard conditions.
def _guard(*steps: Any) -> Any:
    node, seen = Node("n"), []
    guard = node.create_guard_condition(lambda: seen.append(1))
    found = [outcome(step, guard) for step in steps]
    _spin(0.2, node)
    return [found, len(seen)]


lines(
    "guard",
    once=lambda: _guard(lambda g: g.trigger()),
    twice=lambda: _guard(lambda g: g.trigger(), lambda g: g.trigger()),
    never=lambda: _guard(),
    destroyed=lambda: _guard(lambda g: g.destroy(), lambda g: g.trigger()),
    callback_none=lambda: outcome(lambda: Node("n").create_guard_condition(None) is None),
    callback_wrong=lambda: outcome(lambda: _trigger_wrong()),
    group=lambda: _group_of(lambda node, group: node.create_guard_condition(print, callback_group=group)),
)


def _trigger_wrong() -> Any:
    node = Node("n")
    node.create_guard_condition(lambda a: None).trigger()
    return outcome(_spin, 0.2, node)


# Entities that a node lists; entities of actions are not included.
def _listed(make: Any, make_node: Any = Node) -> Any:
    node = make_node("n")
    made = make(node)
    found = [
        [one.topic_name for one in node.publishers],
        [one.topic_name for one in node.subscriptions],
        [one.srv_name for one in node.clients],
        [one.srv_name for one in node.services],
        [len(list(getattr(node, name))) for name in ("timers", "guards")],
    ]
    if hasattr(made, "destroy"):
        found.append(outcome(made.destroy))
    node.destroy_node()
    return found


lines(
    "listed",
    plain=lambda: _listed(lambda node: None),
    publisher=lambda: _listed(lambda node: node.create_publisher(Int32, "t", 1)),
    subscription=lambda: _listed(lambda node: node.create_subscription(Int32, "/t", print, 1)),
    service=lambda: _listed(lambda node: node.create_service(Trigger, "s", print)),
    client=lambda: _listed(lambda node: node.create_client(Trigger, "s")),
    timer=lambda: _listed(lambda node: node.create_timer(1.0, print)),
    rate=lambda: _listed(lambda node: node.create_rate(1.0)),
    guard=lambda: _listed(lambda node: node.create_guard_condition(print)),
    action_server=lambda: _listed(lambda node: ActionServer(node, Fibonacci, "a", print)),
    action_client=lambda: _listed(lambda node: ActionClient(node, Fibonacci, "a")),
    both_ends=lambda: _listed(
        lambda node: [ActionServer(node, Fibonacci, "a", print), ActionClient(node, Fibonacci, "a")]
    ),
    feedback=lambda: _listed(
        lambda node: node.create_subscription(Fibonacci.Impl.FeedbackMessage, "a/_action/feedback", print, 1)
    ),
    parameter_client=lambda: _listed(lambda node: AsyncParameterClient(node, "other")),
    parameter_events=lambda: _listed(lambda node: ParameterEventHandler(node)),
    lifecycle=lambda: _listed(lambda node: None, LifecycleNode),
    lifecycle_publisher=lambda: _listed(
        lambda node: node.create_lifecycle_publisher(Int32, "t", 1), LifecycleNode
    ),
    sim_time=lambda: _listed(
        lambda node: node.set_parameters([Parameter("use_sim_time", Parameter.Type.BOOL, True)])
    ),
)


if __name__ == "__main__":
    main()
