# mypy: ignore-errors
"""Lifecycle nodes, guard conditions, events of endpoints, and bytes of messages.

Many of the calls are wrong on purpose.
"""

import time
from typing import Any

import rclpy
from geometry_msgs.msg import Point, PoseStamped, TransformStamped
from lifecycle_msgs.msg import State, Transition, TransitionEvent
from probing import lines, main, outcome, probe
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_sensor_data,
)
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import Image, JointState, LaserScan, PointCloud2
from std_msgs.msg import ByteMultiArray, Empty, Float64MultiArray, Header, Int32, String

SUCCESS, FAILURE, ERROR = (
    TransitionCallbackReturn.SUCCESS,
    TransitionCallbackReturn.FAILURE,
    TransitionCallbackReturn.ERROR,
)


def _spin(node: Any, seconds: float = 0.2) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.02)


class Machine(LifecycleNode):
    """A lifecycle node that notes its callbacks and returns what it is told."""

    def __init__(self, **results: Any) -> None:
        super().__init__("machine")
        self.calls: list[Any] = []
        self._results = results
        self.publisher = self.create_lifecycle_publisher(Int32, "value", 10)

    def _note(self, name: str, state: Any) -> Any:
        self.calls.append((name, state.label, state.state_id))
        result = self._results.get(name, SUCCESS)
        if isinstance(result, Exception):
            raise result
        return result

    def on_configure(self, state: Any) -> Any:
        return self._note("configure", state)

    def on_activate(self, state: Any) -> Any:
        super().on_activate(state)
        return self._note("activate", state)

    def on_deactivate(self, state: Any) -> Any:
        super().on_deactivate(state)
        return self._note("deactivate", state)

    def on_cleanup(self, state: Any) -> Any:
        return self._note("cleanup", state)

    def on_shutdown(self, state: Any) -> Any:
        return self._note("shutdown", state)

    def on_error(self, state: Any) -> Any:
        return self._note("error", state)


def _run(*steps: str, **results: Any) -> list[Any]:
    node = Machine(**results)
    returned = [outcome(lambda step=step: getattr(node, f"trigger_{step}")()) for step in steps]
    return [returned, node.calls, node.publisher.is_activated]


def _state(node: Any) -> Any:
    return outcome(lambda: node._state_machine.current_state)


lines(
    "machine",
    configured=lambda: _run("configure"),
    active=lambda: _run("configure", "activate"),
    active_fails=lambda: _run("configure", "activate", activate=FAILURE),
    active_raises=lambda: _run("configure", "activate", activate=ValueError("why")),
    active_errs_and_recovers=lambda: _run("configure", "activate", "configure", activate=ERROR),
    deactivate_errs=lambda: _run("configure", "activate", "deactivate", deactivate=ERROR),
    cleanup_errs=lambda: _run("configure", "cleanup", cleanup=ERROR),
    shutdown_errs=lambda: _run("shutdown", shutdown=ERROR),
    shutdown_fails=lambda: _run("shutdown", shutdown=FAILURE),
    error_raises=lambda: _run("configure", configure=ERROR, error=KeyError("x")),
    error_fails_then_configure=lambda: _run("configure", "configure", configure=ERROR, error=FAILURE),
    result_none=lambda: _run("configure", configure=None),
    result_false=lambda: _run("configure", configure=False),
    result_number=lambda: _run("configure", configure=97),
    result_state=lambda: _run("configure", configure=State.PRIMARY_STATE_INACTIVE),
    wrong_order=lambda: _run("activate", "configure", "cleanup", "cleanup"),
    two_lives=lambda: _run("configure", "activate", "deactivate", "cleanup") + _run("configure"),
)


@probe
def published_only_while_active() -> list[Any]:
    node, values = Machine(), []
    node.create_subscription(Int32, "value", lambda message: values.append(message.data), 10)
    for number, step in enumerate(("configure", "activate", "deactivate", "cleanup")):
        getattr(node, f"trigger_{step}")()
        node.publisher.publish(Int32(data=number))
        _spin(node, 0.15)
    return values


@probe
def transition_events() -> list[Any]:
    node, events = Machine(), []
    node.create_subscription(
        TransitionEvent,
        "machine/transition_event",
        lambda event: events.append((event.start_state.label, event.goal_state.label)),
        10,
    )
    _spin(node, 0.2)
    node.trigger_configure()
    node.trigger_activate()
    _spin(node)
    return events


lines(
    "lifecycle",
    state_text=lambda: LifecycleState("active", 3),
    state_fields=lambda: (lambda one: (one.label, one.state_id))(LifecycleState("active", 3)),
    state_by_name=lambda: LifecycleState(label="x", state_id=9).label,
    state_without=lambda: LifecycleState(),
    results=lambda: [(one.name, one.value) for one in (SUCCESS, FAILURE, ERROR)],
    default_callbacks=lambda: [
        getattr(LifecycleNode("l"), f"on_{name}")(LifecycleState("x", 1))
        for name in ("configure", "cleanup", "shutdown", "activate", "deactivate", "error")
    ],
    default_life=lambda: [
        getattr(node, f"trigger_{step}")()
        for node in (LifecycleNode("l"),)
        for step in ("configure", "activate", "deactivate", "cleanup", "shutdown")
    ],
    without_services=lambda: sorted(
        name
        for name, _ in LifecycleNode("l", enable_communication_interface=False).get_service_names_and_types()
        if name.startswith("/l/") and "parameter" not in name and "type_desc" not in name
    ),
    with_services=lambda: sorted(
        name
        for name, _ in LifecycleNode("l").get_service_names_and_types()
        if name.startswith("/l/") and "parameter" not in name and "type_desc" not in name
    ),
    namespace=lambda: LifecycleNode("l", namespace="/a").get_fully_qualified_name(),
    register_callback=lambda: LifecycleNode("l").register_callback(1, print),
    register_callback_text=lambda: LifecycleNode("l").register_callback("configure", print),
    callback_of_a_transition=lambda: _registered(),
    constants=lambda: [
        State.PRIMARY_STATE_UNCONFIGURED,
        State.PRIMARY_STATE_FINALIZED,
        Transition.TRANSITION_CONFIGURE,
        Transition.TRANSITION_ACTIVE_SHUTDOWN,
    ],
    is_a_node=lambda: isinstance(LifecycleNode("l"), Node),
    timer_before_configuring=lambda: type(LifecycleNode("l").create_timer(1.0, print)).__name__,
    publisher_is_inactive=lambda: Machine().publisher.is_activated,
    publisher_of_text=lambda: Machine().publisher.publish("x"),
    publisher_activated_by_hand=lambda: (
        lambda one: [one.on_activate(LifecycleState("x", 1)), one.is_activated]
    )(Machine().publisher),
    destroyed_publisher=lambda: (lambda node: node.destroy_lifecycle_publisher(node.publisher))(Machine()),
    destroyed_as_publisher=lambda: (lambda node: node.destroy_publisher(node.publisher))(Machine()),
)


def _registered() -> Any:
    node, calls = LifecycleNode("l"), []
    node.register_callback(
        State.TRANSITION_STATE_CONFIGURING, lambda state: calls.append(state.label) or SUCCESS
    )
    return [node.trigger_configure(), calls]


def _guarded(*steps: str) -> list[Any]:
    node, calls = Node("n"), []
    guard = node.create_guard_condition(lambda: calls.append("called"))
    for step in steps:
        if step == "spin":
            _spin(node, 0.1)
        elif step == "destroy":
            calls.append(node.destroy_guard_condition(guard))
        else:
            calls.append(outcome(guard.trigger))
    return calls


lines(
    "guard",
    triggered=lambda: _guarded("trigger", "spin"),
    twice=lambda: _guarded("trigger", "trigger", "spin"),
    again=lambda: _guarded("trigger", "spin", "trigger", "spin"),
    never=lambda: _guarded("spin"),
    destroyed=lambda: _guarded("destroy", "spin"),
    destroyed_twice=lambda: _guarded("destroy", "destroy"),
    triggered_when_destroyed=lambda: _guarded("destroy", "trigger"),
    callback_is_nothing=lambda: type(Node("n").create_guard_condition(None)).__name__,
    in_the_node=lambda: (lambda node: [node.create_guard_condition(print), len(list(node.guards))][1])(
        Node("n")
    ),
    group=lambda: (
        lambda group, node: node.create_guard_condition(print, callback_group=group).callback_group is group
    )(MutuallyExclusiveCallbackGroup(), Node("n")),
    callback=lambda: Node("n").create_guard_condition(print).callback is print,
)


def _matched(*steps: str, **qos: Any) -> list[Any]:
    node, events = Node("n"), []
    publisher_callbacks = PublisherEventCallbacks(
        matched=lambda info: events.append(
            ("pub", info.total_count, info.total_count_change, info.current_count, info.current_count_change)
        ),
        incompatible_qos=lambda info: events.append(("pub", info.total_count, info.last_policy_kind.name)),
    )
    subscription_callbacks = SubscriptionEventCallbacks(
        matched=lambda info: events.append(
            ("sub", info.total_count, info.total_count_change, info.current_count, info.current_count_change)
        ),
        incompatible_qos=lambda info: events.append(("sub", info.total_count, info.last_policy_kind.name)),
    )
    held = {}
    for step in steps:
        if step == "publisher":
            held[step] = node.create_publisher(
                String, "t", QoSProfile(depth=1, **qos.get("offers", {})), event_callbacks=publisher_callbacks
            )
        elif step == "subscription":
            held[step] = node.create_subscription(
                String,
                "t",
                lambda _: None,
                QoSProfile(depth=1, **qos.get("asks", {})),
                event_callbacks=subscription_callbacks,
            )
        elif step == "end of the publisher":
            node.destroy_publisher(held["publisher"])
        else:
            node.destroy_subscription(held["subscription"])
        _spin(node, 0.2)
    return sorted(events)


BEST_EFFORT = {"reliability": ReliabilityPolicy.BEST_EFFORT}
LATCHED = {"durability": DurabilityPolicy.TRANSIENT_LOCAL}
lines(
    "event",
    publisher_first=lambda: _matched("publisher", "subscription"),
    subscription_first=lambda: _matched("subscription", "publisher"),
    end_of_the_subscription=lambda: _matched("publisher", "subscription", "end of the subscription"),
    end_of_the_publisher=lambda: _matched("publisher", "subscription", "end of the publisher"),
    alone=lambda: _matched("publisher"),
    reliability=lambda: _matched("publisher", "subscription", offers=BEST_EFFORT),
    durability=lambda: _matched("publisher", "subscription", asks=LATCHED),
    both_policies=lambda: _matched("publisher", "subscription", offers=BEST_EFFORT, asks=LATCHED),
    deadline=lambda: _matched("publisher", "subscription", asks={"deadline": Duration(seconds=1)}),
    liveliness=lambda: _matched(
        "publisher", "subscription", asks={"liveliness": LivelinessPolicy.MANUAL_BY_TOPIC}
    ),
    lease=lambda: _matched(
        "publisher", "subscription", asks={"liveliness_lease_duration": Duration(seconds=1)}
    ),
    callbacks_default=lambda: [
        getattr(SubscriptionEventCallbacks(), name)
        for name in ("deadline", "liveliness", "message_lost", "incompatible_qos", "matched")
    ],
    callbacks_without_defaults=lambda: (
        SubscriptionEventCallbacks(use_default_callbacks=False).use_default_callbacks
    ),
    callbacks_of_the_other_side=lambda: (
        type(
            Node("n").create_publisher(String, "t", 1, event_callbacks=SubscriptionEventCallbacks())
        ).__name__
    ),
    callbacks_nothing=lambda: type(Node("n").create_publisher(String, "t", 1, event_callbacks=None)).__name__,
    callbacks_text=lambda: Node("n").create_publisher(String, "t", 1, event_callbacks="x"),
    handlers=lambda: len(Node("n").create_publisher(String, "t", 1).event_handlers),
    handlers_of_a_subscription=lambda: len(
        Node("n").create_subscription(String, "t", print, 1).event_handlers
    ),
)


def _bytes(message: Any) -> Any:
    data = serialize_message(message)
    # The real rclpy leaves chance bytes as padding and behind some messages.
    return [type(data).__name__, data[:4], deserialize_message(data, type(message)) == message]


lines(
    "bytes",
    text=lambda: _bytes(String(data="hé")),
    nothing=lambda: _bytes(Empty()),
    header=lambda: _bytes(Header(frame_id="map")),
    point=lambda: _bytes(Point(x=1.0)),
    pose=lambda: _bytes(PoseStamped()),
    transform=lambda: _bytes(TransformStamped(child_frame_id="a")),
    joints=lambda: _bytes(JointState(name=["a", "bc"], position=[1.0, 2.0])),
    scan=lambda: _bytes(LaserScan(ranges=[1.0, float("inf")])),
    image=lambda: _bytes(Image(height=1, width=2, data=b"ab")),
    cloud=lambda: _bytes(PointCloud2(width=1, data=[1, 2])),
    array=lambda: _bytes(Float64MultiArray(data=[1.0])),
    byte_array=lambda: _bytes(ByteMultiArray(data=[b"a"])),
    of_a_class=lambda: serialize_message(String),
    of_nothing=lambda: serialize_message(None),
    of_text=lambda: serialize_message("x"),
    of_a_dictionary=lambda: serialize_message({"data": "x"}),
    two_arguments=lambda: serialize_message(String(), String),
    into_an_instance=lambda: deserialize_message(serialize_message(String(data="a")), String()),
    into_text=lambda: deserialize_message(serialize_message(String(data="a")), "std_msgs/msg/String"),
    from_a_bytearray=lambda: deserialize_message(bytearray(serialize_message(String(data="a"))), String),
    from_a_list=lambda: deserialize_message(list(serialize_message(String(data="a"))), String),
    from_text=lambda: deserialize_message("abc", String),
    swapped=lambda: deserialize_message(String, serialize_message(String(data="a"))),
    big_endian=lambda: deserialize_message(b"\0\0\0\0\0\0\0\x02a\0", String),
)


def _raw(data: Any) -> list[Any]:
    node, received = Node("n"), []
    publisher = node.create_publisher(String, "t", 10)
    node.create_subscription(String, "t", lambda message: received.append(message.data), 10)
    _spin(node, 0.1)
    published = outcome(lambda: publisher.publish(data))
    _spin(node, 0.2)
    return [published, received]


lines(
    "raw",
    message=lambda: _raw(String(data="a")),
    bytes_of_a_message=lambda: _raw(serialize_message(String(data="a"))),
    bytearray_of_a_message=lambda: _raw(bytearray(serialize_message(String(data="a")))),
    memoryview_of_a_message=lambda: _raw(memoryview(serialize_message(String(data="a")))),
    text=lambda: _raw("a"),
    nothing=lambda: _raw(None),
    number=lambda: _raw(5),
    other_message=lambda: _raw(Int32(data=5)),
    same_class_twice=lambda: [_raw(String(data="a")), _raw(String(data="b"))],
)


def _callback(callback: Any, **options: Any) -> Any:
    node, calls = Node("n"), []
    publisher = node.create_publisher(String, "t", 10)
    made = outcome(lambda: node.create_subscription(String, "t", callback(calls), 10, **options))
    if not made.startswith("<rclpy"):
        return made
    _spin(node, 0.1)
    publisher.publish(String(data="a"))
    return [outcome(lambda: _spin(node, 0.2)), calls]


lines(
    "subscription",
    one_argument=lambda: _callback(lambda calls: lambda message: calls.append(message.data)),
    with_info=lambda: _callback(lambda calls: lambda message, info: calls.append(sorted(info))),
    no_argument=lambda: _callback(lambda calls: lambda: calls.append(1)),
    three_arguments=lambda: _callback(lambda calls: lambda a, b, c: calls.append(1)),
    any_arguments=lambda: _callback(lambda calls: lambda *args: calls.append(len(args))),
    default_argument=lambda: _callback(lambda calls: lambda message, more=5: calls.append(more)),
    keyword_argument=lambda: _callback(lambda calls: lambda message, *, more=5: calls.append(more)),
    a_class=lambda: _callback(lambda calls: dict),
    nothing=lambda: _callback(lambda calls: None),
    text=lambda: _callback(lambda calls: "on_message"),
    returned=lambda: _callback(lambda calls: calls.append(1)),
    raw=lambda: _callback(lambda calls: lambda message: calls.append(type(message).__name__), raw=True),
    coroutine=lambda: _callback(_coroutine_callback),
    fails=lambda: _callback(lambda calls: lambda message: 1 / 0),
    sensor_qos=lambda: (
        Node("n").create_subscription(String, "t", print, qos_profile_sensor_data).qos_profile.history.name
    ),
    keep_all=lambda: (
        Node("n")
        .create_subscription(String, "t", print, QoSProfile(history=HistoryPolicy.KEEP_ALL))
        .qos_profile.depth
    ),
    arguments_in_another_order=lambda: Node("n").create_subscription(String, print, "t", 10),
    qos_forgotten=lambda: Node("n").create_subscription(String, "t", print),
    topic_is_a_number=lambda: Node("n").create_subscription(String, 5, print, 10),
    count_of_publishers=lambda: Node("n").create_subscription(String, "t", print, 10).get_publisher_count(),
    name=lambda: Node("n", namespace="/a").create_subscription(String, "t", print, 10).topic_name,
    private_name=lambda: Node("n", namespace="/a").create_subscription(String, "~/t", print, 10).topic_name,
    logger_name=lambda: Node("n").create_subscription(String, "t", print, 10).logger_name,
    changed_callback=lambda: _changed_callback(),
)


def _coroutine_callback(calls: list[Any]) -> Any:
    async def on_message(message: Any) -> None:
        calls.append(message.data)

    return on_message


def _changed_callback() -> list[Any]:
    node, calls = Node("n"), []
    publisher = node.create_publisher(String, "t", 10)
    subscription = node.create_subscription(String, "t", lambda message: calls.append("first"), 10)
    subscription.callback = lambda message: calls.append("second")
    _spin(node, 0.1)
    publisher.publish(String())
    _spin(node, 0.2)
    return calls


@probe
def executors_of_one_node() -> list[Any]:
    node, first, second = Node("n"), SingleThreadedExecutor(), SingleThreadedExecutor()
    node.executor = first
    was_first = node.executor is first
    node.executor = second
    is_in_first = node in first.get_nodes()
    node.executor = None
    return [was_first, is_in_first, node in second.get_nodes(), node.executor]


if __name__ == "__main__":
    main()
