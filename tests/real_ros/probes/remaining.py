# mypy: ignore-errors
"""Corners of clocks, waiting, parameter clients and events, names and durations.

Most arguments are wrong on purpose, so this file has no types to check.
"""

import math
import warnings

import rclpy
import rclpy.callback_groups
import rclpy.expand_topic_name
import rclpy.logging
import rclpy.serialization
import rclpy.time_source
import rclpy.validate_full_topic_name
import rclpy.validate_namespace
import rclpy.validate_node_name
import rclpy.validate_parameter_name
import rclpy.validate_topic_name
import rclpy.wait_for_message
from probing import lines, main, outcome, probe
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.clock import Clock, ClockChange, JumpThreshold, ROSClock, TimeJump
from rclpy.clock_type import ClockType
from rclpy.duration import Duration, Infinite
from rclpy.guard_condition import GuardCondition
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.parameter_event_handler import ParameterEventHandler
from rclpy.qos import QoSProfile
from rclpy.time import Time
from rclpy.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum
from rclpy.type_hash import TypeHash
from std_msgs.msg import Int32, String

D = Duration
lines(
    "duration",
    add=lambda: D(seconds=1) + D(seconds=2),
    subtract=lambda: D(seconds=1) - D(seconds=2),
    times=lambda: D(seconds=1) * 2,
    times_float=lambda: D(seconds=1) * 0.5,
    from_left=lambda: 2 * D(seconds=1),
    divide=lambda: D(seconds=1) / 2,
    negative=lambda: -D(seconds=1),
    absolute=lambda: abs(D(seconds=-1)),
    as_bool=lambda: (bool(D()), bool(D(seconds=1))),
    as_float=lambda: float(D(seconds=1)),
    compared=lambda: D(seconds=1) < 1,
    equal_to_number=lambda: D(seconds=1) == 1,
    hashed=lambda: hash(D(seconds=1)) == hash(D(seconds=1)),
    infinite=lambda: (Infinite.nanoseconds, str(Infinite), repr(Infinite)),
    both=lambda: D(seconds=1.5, nanoseconds=-1).nanoseconds,
    nan=lambda: D(seconds=math.nan),
    infinity=lambda: D(seconds=math.inf),
    big=lambda: D(seconds=2**40),
    positional=lambda: D(1),
    text=lambda: D(seconds="1"),
    max=lambda: max(D(seconds=1), D(nanoseconds=5)),
    summed=lambda: sum([D(seconds=1), D(seconds=2)]),
    of_message=lambda: D.from_msg(D(seconds=-1.5).to_msg()).nanoseconds,
    message=lambda: D(seconds=-1.5).to_msg(),
)
lines(
    "threshold",
    none=lambda: JumpThreshold(min_forward=None, min_backward=None, on_clock_change=False),
    negative=lambda: JumpThreshold(min_forward=D(seconds=-1), min_backward=D(seconds=-1)),
    zero_forward=lambda: JumpThreshold(min_forward=D(), min_backward=None),
    zero_backward=lambda: JumpThreshold(min_forward=None, min_backward=D()),
    positive_backward=lambda: JumpThreshold(min_forward=None, min_backward=D(seconds=1)),
    number=lambda: JumpThreshold(min_forward=1, min_backward=None),
    kinds=lambda: [(k.name, k.value) for k in ClockChange],
    jump=lambda: TimeJump(ClockChange.ROS_TIME_NO_CHANGE, D(seconds=1)).delta.nanoseconds,
    jump_kind=lambda: TimeJump(ClockChange.ROS_TIME_ACTIVATED, D()).clock_change.name,
    jump_of_number=lambda: TimeJump(ClockChange.ROS_TIME_NO_CHANGE, 3),
)
lines(
    "clock",
    kind=lambda: (type(Clock()).__name__, Clock().clock_type),
    of_ros=lambda: type(Clock(clock_type=ClockType.ROS_TIME)).__name__,
    of_text=lambda: Clock(clock_type="ros"),
    of_number=lambda: Clock(clock_type=1),
    ros=lambda: ROSClock().ros_time_is_active,
    set_inactive=lambda: ROSClock().set_ros_time_override(Time()),
    set_system=lambda: ROSClock().set_ros_time_override(Time(clock_type=ClockType.STEADY_TIME)),
    repr=lambda: repr(ROSClock()),
    sleep_none=lambda: Clock().sleep_for(None),
    sleep_number=lambda: Clock().sleep_for(1),
    sleep_negative=lambda: Clock().sleep_for(D(seconds=-1)),
    sleep_other_clock=lambda: Clock(clock_type=ClockType.STEADY_TIME).sleep_until(Time()),
    jump_callback_without=lambda: Clock().create_jump_callback(
        JumpThreshold(min_forward=None, min_backward=None)
    ),
    jump_callback_none=lambda: Clock().create_jump_callback(None, post_callback=print),
    jump_callback_number=lambda: Clock().create_jump_callback(
        JumpThreshold(min_forward=None, min_backward=None), post_callback=3
    ),
)
lines(
    "name",
    expand=lambda: rclpy.expand_topic_name.expand_topic_name("~/a", "n", "/ns"),
    expand_node=lambda: rclpy.expand_topic_name.expand_topic_name("{node}/x", "n", "/ns"),
    expand_ns=lambda: rclpy.expand_topic_name.expand_topic_name("{ns}/x", "n", "/ns"),
    expand_unknown=lambda: rclpy.expand_topic_name.expand_topic_name("{what}/x", "n", "/ns"),
    expand_empty=lambda: rclpy.expand_topic_name.expand_topic_name("", "n", "/ns"),
    expand_bad_node=lambda: rclpy.expand_topic_name.expand_topic_name("a", "1n", "/ns"),
    expand_bad_ns=lambda: rclpy.expand_topic_name.expand_topic_name("a", "n", "ns/"),
    expand_root=lambda: rclpy.expand_topic_name.expand_topic_name("a", "n", "/"),
    expand_no_ns=lambda: rclpy.expand_topic_name.expand_topic_name("a", "n", ""),
    full_relative=lambda: rclpy.validate_full_topic_name.validate_full_topic_name("a"),
    full_service=lambda: rclpy.validate_full_topic_name.validate_full_topic_name("a b", is_service=True),
    full_long=lambda: rclpy.validate_full_topic_name.validate_full_topic_name("/" + "a" * 300),
    topic_long=lambda: rclpy.validate_topic_name.validate_topic_name("a" * 300),
    topic_tilde=lambda: rclpy.validate_topic_name.validate_topic_name("a/~b"),
    topic_braces=lambda: rclpy.validate_topic_name.validate_topic_name("a/{b"),
    topic_nested=lambda: rclpy.validate_topic_name.validate_topic_name("{a{b}}"),
    topic_double=lambda: rclpy.validate_topic_name.validate_topic_name("a//b"),
    topic_underscores=lambda: rclpy.validate_topic_name.validate_topic_name("a__b"),
    namespace_long=lambda: rclpy.validate_namespace.validate_namespace("/" + "a" * 260),
    namespace_empty=lambda: rclpy.validate_namespace.validate_namespace(""),
    namespace_digit=lambda: rclpy.validate_namespace.validate_namespace("/1a"),
    node_long=lambda: rclpy.validate_node_name.validate_node_name("a" * 256),
    node_unicode=lambda: rclpy.validate_node_name.validate_node_name("café"),
    node_none=lambda: rclpy.validate_node_name.validate_node_name(None),
    node_number=lambda: rclpy.validate_node_name.validate_node_name(3),
    namespace_none=lambda: rclpy.validate_namespace.validate_namespace(None),
    namespace_number=lambda: rclpy.validate_namespace.validate_namespace(3),
    full_none=lambda: rclpy.validate_full_topic_name.validate_full_topic_name(None),
    topic_none=lambda: rclpy.validate_topic_name.validate_topic_name(None),
    expand_none=lambda: rclpy.expand_topic_name.expand_topic_name(None, "n", "/"),
    expand_node_none=lambda: rclpy.expand_topic_name.expand_topic_name("t", None, "/"),
    expand_ns_none=lambda: rclpy.expand_topic_name.expand_topic_name("t", "n", None),
    expand_ns_number=lambda: rclpy.expand_topic_name.expand_topic_name("t", "n", 3),
    parameter=lambda: rclpy.validate_parameter_name.validate_parameter_name("a.b"),
    parameter_empty=lambda: rclpy.validate_parameter_name.validate_parameter_name(""),
    parameter_space=lambda: rclpy.validate_parameter_name.validate_parameter_name("a b"),
)
lines(
    "endpoint",
    kinds=lambda: [(k.name, k.value) for k in TopicEndpointTypeEnum],
    empty=lambda: str(TopicEndpointInfo()),
    of_names=lambda: TopicEndpointInfo(node_name="n", node_namespace="/", topic_type="t").node_name,
    gid=lambda: TopicEndpointInfo(endpoint_gid=[1, 2]).endpoint_gid,
    kind_of_number=lambda: TopicEndpointInfo(endpoint_type=1).endpoint_type,
    bad_kind=lambda: TopicEndpointInfo(endpoint_type=9).endpoint_type,
    equal=lambda: TopicEndpointInfo() == TopicEndpointInfo(),
    hash_default=lambda: str(TypeHash()),
    hash_equal=lambda: TypeHash() == TypeHash(),
    hash_of=lambda: str(TypeHash(version=1, value=b"\0" * 32)),
    hash_short=lambda: str(TypeHash(version=1, value=b"\0")),
)
lines(
    "serialization",
    text=lambda: rclpy.serialization.serialize_message("a"),
    class_itself=lambda: rclpy.serialization.serialize_message(String),
    round=lambda: rclpy.serialization.deserialize_message(
        rclpy.serialization.serialize_message(Int32(data=7)), Int32
    ),
    bytearray=lambda: rclpy.serialization.deserialize_message(
        bytearray(rclpy.serialization.serialize_message(Int32(data=7))), Int32
    ),
    to_instance=lambda: rclpy.serialization.deserialize_message(b"\0\1\0\0\7\0\0\0", Int32()),
    big_endian=lambda: rclpy.serialization.deserialize_message(b"\0\0\0\0\0\0\0\7", Int32),
)
lines(
    "group",
    reentrant=lambda: [a for a in dir(ReentrantCallbackGroup()) if a[0] != "_"],
    exclusive=lambda: [a for a in dir(MutuallyExclusiveCallbackGroup()) if a[0] != "_"],
    abstract=lambda: rclpy.callback_groups.CallbackGroup(),
    end=lambda: outcome(MutuallyExclusiveCallbackGroup().ending_execution, None),
    has=lambda: MutuallyExclusiveCallbackGroup().has_entity(None),
    add_none=lambda: MutuallyExclusiveCallbackGroup().add_entity(None),
    can_none=lambda: MutuallyExclusiveCallbackGroup().can_execute(None),
    begin_none=lambda: MutuallyExclusiveCallbackGroup().beginning_execution(None),
    can_stranger=lambda: MutuallyExclusiveCallbackGroup().can_execute(ReentrantCallbackGroup()),
    begin_stranger=lambda: MutuallyExclusiveCallbackGroup().beginning_execution(ReentrantCallbackGroup()),
    reentrant_can_none=lambda: ReentrantCallbackGroup().can_execute(None),
)


def _waited(**options: object) -> object:
    node = Node("waiting")
    try:
        return rclpy.wait_for_message.wait_for_message(String, node, "chatter", **options)
    finally:
        node.destroy_node()


lines(
    "wait",
    zero=lambda: _waited(time_to_wait=0),
    short=lambda: _waited(time_to_wait=0.01),
    negative_int=lambda: _waited(time_to_wait="x"),
    qos=lambda: _waited(qos_profile=3, time_to_wait=0.01),
    qos_text=lambda: _waited(qos_profile="a", time_to_wait=0.01),
)


@probe
def wait_latched() -> object:
    node = Node("waiting")
    qos = QoSProfile(depth=1, durability=1)
    node.create_publisher(String, "latched", qos).publish(String(data="hi"))
    found = rclpy.wait_for_message.wait_for_message(
        String, node, "latched", qos_profile=qos, time_to_wait=2.0
    )
    return found, [s.topic_name for s in node.subscriptions]


@probe
def guard() -> object:
    called = []
    node = Node("guarding")
    group = MutuallyExclusiveCallbackGroup()
    condition = GuardCondition(lambda: called.append(1), group, context=rclpy.get_default_context())
    made = node.create_guard_condition(lambda: called.append(2))
    for _ in range(3):
        made.trigger()
    rclpy.spin_once(node, timeout_sec=0.2)
    rclpy.spin_once(node, timeout_sec=0.05)
    return called, type(condition).__name__, len(list(node.guards)), node.destroy_guard_condition(made)


@probe
def guard_destroyed() -> object:
    node = Node("guarding")
    made = node.create_guard_condition(print)
    made.destroy()
    return outcome(made.trigger), outcome(made.destroy)


@probe
def logger_children() -> object:
    logger = Node("talker").get_logger()
    return [
        outcome(lambda: logger.get_child("a").name),
        outcome(lambda: logger.get_child("a").get_child("b").name),
        outcome(lambda: logger.get_child("")),
        outcome(lambda: logger.get_child(None)),
        outcome(lambda: logger.get_child(3)),
        outcome(lambda: rclpy.logging.get_logger("")),
        outcome(lambda: rclpy.logging.get_logger("").get_child("x").name),
        outcome(lambda: rclpy.logging.get_logger(3)),
        outcome(lambda: logger == Node("talker2").get_logger()),
        outcome(lambda: logger.get_child("a").get_effective_level()),
    ]


@probe
def logger_filters() -> object:
    logger = rclpy.logging.get_logger("filters")
    said = [logger.info("x", once=True) for _ in range(3)]
    skipped = [logger.info("y", skip_first=True) for _ in range(3)]
    clock = Clock()
    throttled = [
        logger.info("z", throttle_duration_sec=60, throttle_time_source_type=clock) for _ in range(3)
    ]
    return said, skipped, throttled


def _log(**options: object) -> object:
    return rclpy.logging.get_logger("filters").info("w", **options)


lines(
    "log",
    unknown=lambda: _log(often=True),
    throttle_text=lambda: _log(throttle_duration_sec="1"),
    throttle_negative=lambda: _log(throttle_duration_sec=-1),
    source_alone=lambda: _log(throttle_time_source_type="RCUTILS_STEADY_TIME"),
    source_bad=lambda: _log(throttle_duration_sec=1, throttle_time_source_type="none"),
    once_false=lambda: _log(once=False),
    once_and_skip=lambda: _log(once=True, skip_first=True),
    severity=lambda: rclpy.logging.get_logger("f").log("a", 15),
    severity_text=lambda: rclpy.logging.get_logger("f").log("a", "INFO"),
    level_text=lambda: rclpy.logging.get_logger("f").set_level("INFO"),
    level_number=lambda: rclpy.logging.get_logger("f").set_level(10),
    level_odd=lambda: rclpy.logging.get_logger("f").set_level(15),
    severity_names=lambda: [
        outcome(rclpy.logging.get_logging_severity_from_string, name) for name in ("INFO", "info", "x", "")
    ],
    enabled=lambda: rclpy.logging.get_logger("f").is_enabled_for(rclpy.logging.LoggingSeverity.DEBUG),
)


@probe
def parameter_client() -> object:
    node = Node("asking")
    other = Node("answering")
    other.declare_parameter("a", 1)
    client = AsyncParameterClient(node, "answering")
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(node)
    executor.add_node(other)
    ready = client.wait_for_services(5.0)

    def ask(method: str, *args: object) -> str:
        def call() -> object:
            future = getattr(client, method)(*args)
            executor.spin_until_future_complete(future, 5.0)
            return future.result()

        return outcome(call)

    answers = [
        ask("get_parameters", ["a"]),
        ask("get_parameters", []),
        ask("get_parameters", ["a", "b"]),
        ask("get_parameter_types", ["a", "b"]),
        ask("describe_parameters", ["a", "b"]),
        ask("list_parameters", ["a"], 1),
        ask("list_parameters"),
        ask("set_parameters", [Parameter("a", value=2)]),
        ask("set_parameters", [Parameter("a", value="x")]),
        ask("set_parameters", []),
        ask("set_parameters_atomically", [Parameter("a", value=3), Parameter("b", value=3)]),
        ask("set_parameters_atomically", []),
        ask("delete_parameters", ["a", "b"]),
        ask("load_parameter_file", "/nothing.yaml"),
    ]
    return ready, client.services_are_ready(), answers


@probe
def parameter_client_of_nothing() -> object:
    client = AsyncParameterClient(Node("asking"), "nothing")
    return client.wait_for_services(0.01), client.services_are_ready(), client.remote_node_name


@probe
def parameter_events() -> object:
    node = Node("watching")
    node.declare_parameter("a", 1)
    handler = ParameterEventHandler(node)
    heard: list[object] = []
    one = handler.add_parameter_callback("a", "watching", lambda p: heard.append(("one", p.name)))
    same = handler.add_parameter_callback("a", "/watching", lambda p: heard.append(("same", p.name)))
    every = handler.add_parameter_event_callback(lambda e: heard.append(("event", len(e.changed_parameters))))
    node.set_parameters([Parameter("a", value=2)])
    for _ in range(5):
        rclpy.spin_once(node, timeout_sec=0.1)
    kinds = [type(one).__name__, type(every).__name__]
    handler.remove_parameter_callback(one)
    handler.remove_parameter_event_callback(every)
    node.set_parameters([Parameter("a", value=3)])
    for _ in range(5):
        rclpy.spin_once(node, timeout_sec=0.1)
    again = (
        outcome(handler.remove_parameter_callback, one),
        outcome(handler.remove_parameter_event_callback, every),
    )
    return heard, kinds, again, same.parameter_name, same.node_name


@probe
def parameter_events_of_event() -> object:
    node = Node("watching")
    handler = ParameterEventHandler(node)
    event = rclpy.parameter.ParameterMsg if hasattr(rclpy.parameter, "ParameterMsg") else None
    from rcl_interfaces.msg import ParameterEvent

    message = ParameterEvent(node="/x", new_parameters=[Parameter("a", value=1).to_parameter_msg()])
    return (
        event is not None,
        handler.get_parameter_from_event(message, "a", "/x"),
        outcome(handler.get_parameter_from_event, message, "b", "/x"),
        outcome(handler.get_parameter_from_event, message, "a", "x"),
        [p.name for p in handler.get_parameters_from_event(message)],
    )


@probe
def deprecated_module() -> object:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        import rclpy.qos_event as old
    return len(caught), sorted(name for name in vars(old) if name[0] == "Q")[:3]


@probe
def time_source() -> object:
    node = Node("timed")
    source = rclpy.time_source.TimeSource(node=node)
    clock = ROSClock()
    source.attach_clock(clock)
    before = source.ros_time_is_active, clock.ros_time_is_active
    source.ros_time_is_active = True
    after = source.ros_time_is_active, clock.ros_time_is_active, clock.now().nanoseconds
    source.ros_time_is_active = False
    return (
        before,
        after,
        clock.ros_time_is_active,
        outcome(source.attach_clock, Clock()),
        outcome(source.attach_clock, None),
        outcome(source.attach_node, None),
        outcome(source.detach_node),
    )


if __name__ == "__main__":
    main()
