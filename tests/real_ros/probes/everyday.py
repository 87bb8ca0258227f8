# mypy: ignore-errors
"""What ordinary programs do with parameters, events, logs, bytes, types, lifecycles and services.

Many of the calls are wrong on purpose.
"""

import hashlib
import importlib
import threading
import time
from functools import partial
from typing import Any

import rclpy
from geometry_msgs.msg import PoseStamped, Twist
from lifecycle_msgs.msg import State as StateMessage
from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState
from probing import Fibonacci, lines, main, outcome, response, spun
from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rcl_interfaces.srv import DescribeParameters, GetParameterTypes, ListParameters, SetParametersAtomically
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.logging import LoggingSeverity
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSCompatibility, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.wait_for_message import wait_for_message
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import Header, Int32, String
from std_srvs.srv import SetBool, Trigger
from type_description_interfaces.srv import GetTypeDescription
from visualization_msgs.msg import Marker


def ranged(descriptor: Any, value: Any, *new: Any) -> Any:
    node = Node("n")
    declared = outcome(lambda: node.declare_parameter("p", value, descriptor).value)
    results = [
        (one.successful, one.reason)
        for one in (node.set_parameters([Parameter("p", value=v)])[0] for v in new)
    ]
    return declared, results


def ints(start: int, stop: int, step: int) -> Any:
    return ParameterDescriptor(integer_range=[IntegerRange(from_value=start, to_value=stop, step=step)])


def floats(start: float, stop: float, step: float) -> Any:
    return ParameterDescriptor(
        floating_point_range=[FloatingPointRange(from_value=start, to_value=stop, step=step)]
    )


def parameter_service(kind: Any, name: str, request: Any, *fields: str) -> Any:
    node = Node("n")
    node.declare_parameter("a.b", 1, ParameterDescriptor(description="d", read_only=True))
    node.declare_parameter("a.c", "text")
    node.declare_parameter("x", 1.5)
    return response(node, kind, f"/n/{name}", request)


def order_of_callbacks() -> Any:
    node, log = Node("n"), []
    node.declare_parameter("p", 1)
    node.add_pre_set_parameters_callback(lambda ps: log.append("pre") or ps)
    node.add_on_set_parameters_callback(lambda ps: log.append("on") or SetParametersResult(successful=True))
    node.add_on_set_parameters_callback(lambda ps: log.append("on2") or SetParametersResult(successful=True))
    node.add_post_set_parameters_callback(lambda ps: log.append(("post", ps[0].value)))
    node.set_parameters([Parameter("p", value=2)])
    return log


def events_of_parameters() -> Any:
    from rcl_interfaces.msg import ParameterEvent

    node, events = Node("n"), []
    node.create_subscription(
        ParameterEvent,
        "/parameter_events",
        lambda e: events.append(
            (
                [p.name for p in e.new_parameters],
                [p.name for p in e.changed_parameters],
                [p.name for p in e.deleted_parameters],
            )
        ),
        10,
    )
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.spin_once(timeout_sec=0.2)
    events.clear()
    node.declare_parameters("g", [("a", 1), ("b", 2)])
    node.set_parameters([Parameter("g.a", value=5), Parameter("g.b", value=6)])
    node.set_parameters_atomically([Parameter("g.a", value=7), Parameter("g.b", value=8)])
    node.undeclare_parameter("g.b")
    end = time.monotonic() + 1.0
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.1)
    executor.shutdown()
    return events


lines(
    "range",
    ints=lambda: ranged(ints(0, 10, 2), 4, 6, 5, 12, -2, 10),
    ints_without_step=lambda: ranged(ints(0, 10, 0), 4, 5, 11),
    ints_end=lambda: ranged(ints(0, 9, 2), 4, 9, 8),
    floats=lambda: ranged(floats(0.0, 1.0, 0.25), 0.5, 0.75, 0.3, 1.5),
    floats_near=lambda: ranged(floats(0.0, 1.0, 0.1), 0.5, 0.3, 0.30000000001),
    bad_start=lambda: ranged(ints(0, 10, 2), 5),
    other_type=lambda: ranged(ints(0, 10, 2), "a", "b"),
    dynamic=lambda: ranged(ParameterDescriptor(dynamic_typing=True), 4, "a", 1.5),
    read_only=lambda: ranged(ParameterDescriptor(read_only=True), 4, 5),
    typed=lambda: ranged(ParameterDescriptor(type=2), "a"),
    describe=lambda: (
        parameter_service(
            DescribeParameters, "describe_parameters", DescribeParameters.Request(names=["a.b", "x"])
        ).descriptors
    ),
    describe_unknown=lambda: (
        parameter_service(
            DescribeParameters, "describe_parameters", DescribeParameters.Request(names=["nope"])
        ).descriptors
    ),
    types=lambda: (
        parameter_service(
            GetParameterTypes, "get_parameter_types", GetParameterTypes.Request(names=["a.b", "a.c", "x"])
        ).types
    ),
    types_unknown=lambda: (
        parameter_service(
            GetParameterTypes, "get_parameter_types", GetParameterTypes.Request(names=["a.b", "nope"])
        ).types
    ),
    list_prefix=lambda: (
        parameter_service(ListParameters, "list_parameters", ListParameters.Request(prefixes=["a"])).result
    ),
    list_depth=lambda: (
        parameter_service(ListParameters, "list_parameters", ListParameters.Request(depth=1)).result.names
    ),
    atomically=lambda: (
        parameter_service(
            SetParametersAtomically,
            "set_parameters_atomically",
            SetParametersAtomically.Request(
                parameters=[
                    Parameter("x", value=2.5).to_parameter_msg(),
                    Parameter("a.b", value=2).to_parameter_msg(),
                ]
            ),
        ).result
    ),
    order=order_of_callbacks,
    events=events_of_parameters,
)


def qos_events(publisher_qos: Any, subscription_qos: Any, seconds: float = 0.6, publish: int = 0) -> Any:
    """Return the names of the events of a pair, with their total counts."""
    log: list[Any] = []

    def record(name: str) -> Any:
        return lambda event: log.append((name, getattr(event, "total_count", None)))

    node, other = Node("n"), Node("o")
    publisher = node.create_publisher(
        String,
        "t",
        publisher_qos,
        event_callbacks=PublisherEventCallbacks(
            deadline=record("offered deadline"),
            incompatible_qos=record("offered incompatible"),
            matched=lambda e: log.append(("pub matched", e.current_count, e.current_count_change)),
        ),
    )
    subscription = other.create_subscription(
        String,
        "t",
        lambda m: None,
        subscription_qos,
        event_callbacks=SubscriptionEventCallbacks(
            deadline=record("requested deadline"),
            incompatible_qos=record("requested incompatible"),
            matched=lambda e: log.append(("sub matched", e.current_count, e.current_count_change)),
        ),
    )
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.add_node(other)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if publish:
            publisher.publish(String())
            publish -= 1
        executor.spin_once(timeout_sec=0.05)
    other.destroy_subscription(subscription)
    end = time.monotonic() + 0.3
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    executor.shutdown()
    return sorted(set(log), key=str)


BEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
ALL = QoSProfile(history=HistoryPolicy.KEEP_ALL, depth=0)


def with_deadline(milliseconds: int) -> Any:
    return QoSProfile(depth=1, deadline=Duration(nanoseconds=milliseconds * 10**6))


lines(
    "event",
    same=lambda: qos_events(10, 10),
    best_to_reliable=lambda: qos_events(BEST, 10),
    reliable_to_best=lambda: qos_events(10, BEST),
    volatile_to_latched=lambda: qos_events(10, LATCHED),
    latched_to_volatile=lambda: qos_events(LATCHED, 10),
    both=lambda: qos_events(BEST, LATCHED),
    keep_all=lambda: qos_events(ALL, ALL),
    looser_deadline=lambda: qos_events(with_deadline(5000), with_deadline(100)),
    tighter_deadline=lambda: qos_events(with_deadline(5000), with_deadline(9000)),
    no_deadline_offered=lambda: qos_events(1, with_deadline(100)),
    missed=lambda: [name for name, *_ in qos_events(with_deadline(200), with_deadline(200), 1.0)][:1],
)


def logged(use: Any) -> Any:
    """Return the texts of the log messages on /rosout."""
    from rcl_interfaces.msg import Log

    node, seen = Node("n"), []
    other = Node("other")
    other.create_subscription(Log, "/rosout", lambda m: seen.append((m.level, m.name, m.msg)), 100)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.add_node(other)
    end = time.monotonic() + 3.0
    while node.count_subscribers("/rosout") < 1 and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    for _ in range(4):
        executor.spin_once(timeout_sec=0.05)
    use(node)
    node.get_logger().fatal("last")
    end = time.monotonic() + 3.0
    while not any(text == "last" for *_, text in seen) and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    executor.shutdown()
    return [entry for entry in seen if entry[1].startswith("n")]


def repeated(**options: Any) -> Any:
    def use(node: Any) -> None:
        for number in range(4):
            node.get_logger().info(f"text {number}", **options)

    return use


def throttled(node: Any) -> None:
    for _ in range(6):
        node.get_logger().warning("often", throttle_duration_sec=0.25)
        time.sleep(0.1)


def throttled_and_skipped(node: Any) -> None:
    for number in range(4):
        node.get_logger().warning(f"n {number}", throttle_duration_sec=10.0, skip_first=True)


def levels(node: Any) -> None:
    logger = node.get_logger()
    for level in (LoggingSeverity.DEBUG, LoggingSeverity.WARN, LoggingSeverity.ERROR):
        logger.set_level(level)
        for name in ("debug", "info", "warn", "warning", "error", "fatal"):
            getattr(logger, name)(f"{level.name} {name}")
    logger.set_level(LoggingSeverity.INFO)


def children(node: Any) -> None:
    child = node.get_logger().get_child("c")
    child.info("child")
    child.set_level(LoggingSeverity.ERROR)
    child.warn("hidden")
    child.error("seen")
    node.get_logger().info("parent")
    child.set_level(LoggingSeverity.UNSET)


lines(
    "log",
    plain=lambda: logged(repeated()),
    once=lambda: logged(repeated(once=True)),
    skip_first=lambda: logged(repeated(skip_first=True)),
    throttle=lambda: logged(throttled),
    throttle_skip=lambda: logged(throttled_and_skipped),
    levels=lambda: logged(levels),
    children=lambda: logged(children),
    effective=lambda: Node("n").get_logger().get_effective_level().name,
    enabled=lambda: Node("n").get_logger().is_enabled_for(LoggingSeverity.DEBUG),
    call_log=lambda: logged(lambda n: n.get_logger().log("by level", LoggingSeverity.ERROR)),
    once_and_throttle=lambda: outcome(
        lambda: Node("n").get_logger().info("a", once=True, throttle_duration_sec=1.0)
    ),
    two_kinds_in_one_line=lambda: outcome(
        lambda: [
            Node("n").get_logger().log("a", level) for level in (LoggingSeverity.INFO, LoggingSeverity.WARN)
        ]
    ),
    unknown_option=lambda: outcome(lambda: Node("n").get_logger().info("a", every=3)),
    clock_of_throttle=lambda: outcome(
        lambda: (
            Node("n")
            .get_logger()
            .info("a", throttle_duration_sec=1.0, throttle_time_source_type="STEADY_TIME")
        )
    ),
    bad_clock_of_throttle=lambda: outcome(
        lambda: (
            Node("n").get_logger().info("a", throttle_duration_sec=1.0, throttle_time_source_type="NO_TIME")
        )
    ),
)


def raw_subscription(kind: Any, message: Any, **options: Any) -> Any:
    node, received = Node("n"), []
    node.create_subscription(kind, "t", received.append, 10, raw=True, **options)
    publisher = node.create_publisher(kind, "t", 10)
    publisher.publish(message)
    spun(node, lambda: received)
    return [
        (type(one).__name__, len(one) // 4, deserialize_message(one, kind) == message) for one in received
    ]


def published_bytes() -> Any:
    node, received = Node("n"), []
    node.create_subscription(Twist, "t", received.append, 10)
    message = Twist()
    message.linear.x = 2.5
    node.create_publisher(Twist, "t", 10).publish(serialize_message(message))
    spun(node, lambda: received)
    return received


def with_info() -> Any:
    node, received = Node("n"), []

    def on_message(message: Any, info: Any) -> None:
        received.append(
            (message.data, sorted(info), info["received_timestamp"] >= info["source_timestamp"] > 0)
        )

    node.create_subscription(String, "t", on_message, 10)
    node.create_publisher(String, "t", 10).publish(String(data="a"))
    spun(node, lambda: received)
    return received


def round_trip(message: Any) -> Any:
    data = serialize_message(message)
    return type(data).__name__, data[:4].hex(), deserialize_message(data, type(message)) == message


def waited(publish_after: Any, seconds: Any, **options: Any) -> Any:
    node, other = Node("n"), Node("other")
    publisher = other.create_publisher(Int32, "t", options.pop("offered", 10))
    if publish_after is not None:
        timer = threading.Timer(publish_after, lambda: publisher.publish(Int32(data=4)))
        timer.start()
    result = wait_for_message(Int32, node, "t", time_to_wait=seconds, **options)
    left = [one.topic_name for one in node.subscriptions if one.topic_name == "/t"]
    if publish_after is not None:
        timer.join()
    return result, left


def late_message() -> Any:
    node = Node("n")
    node.create_publisher(Int32, "t", LATCHED).publish(Int32(data=7))
    return wait_for_message(Int32, node, "t", qos_profile=LATCHED, time_to_wait=3.0)


lines(
    "raw",
    string=lambda: raw_subscription(String, String(data="abc")),
    scan=lambda: raw_subscription(LaserScan, LaserScan(ranges=[1.0, 2.0])),
    joints=lambda: raw_subscription(JointState, JointState(name=["a", "bc"], position=[1.0, 2.0])),
    published_bytes=published_bytes,
    with_info=with_info,
    trip_marker=lambda: round_trip(Marker(ns="a", id=3)),
    trip_pose=lambda: round_trip(PoseStamped(header=Header(frame_id="map"))),
    trip_empty=lambda: round_trip(Trigger.Request()),
    trip_goal=lambda: round_trip(Fibonacci.Goal()),
    serialize_class=lambda: outcome(serialize_message, String),
    serialize_text=lambda: outcome(serialize_message, "abc"),
    deserialize_class=lambda: deserialize_message(serialize_message(Int32(data=-1)), Int32),
    deserialize_list=lambda: outcome(deserialize_message, [0, 1, 0, 0], Int32),
    deserialize_array=lambda: outcome(
        deserialize_message, bytearray(serialize_message(Int32(data=5))), Int32
    ),
    waited=lambda: waited(0.5, 3.0),
    waited_too_short=lambda: waited(None, 0.2),
    waited_for_nothing=lambda: waited(None, 0),
    waited_with_profile=lambda: waited(0.5, 3.0, qos_profile=QoSProfile(depth=5)),
    waited_incompatible=lambda: waited(0.3, 1.0, offered=BEST),
    late=late_message,
)


def types_of(node_options: Any, request: Any) -> Any:
    node, caller = Node("n", **node_options), Node("caller")
    client = caller.create_client(GetTypeDescription, "/n/get_type_description")
    if not client.wait_for_service(2.0):
        return "no service"
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    executor.add_node(caller)
    future = client.call_async(request)
    executor.spin_until_future_complete(future, 2.0)
    executor.shutdown()
    return future.result() if future.done() else "pending"


def described(**fields: Any) -> Any:
    node_options = fields.pop("node_options", {})
    reply = types_of(node_options, GetTypeDescription.Request(**fields))
    if isinstance(reply, str):
        return reply
    description = reply.type_description.type_description
    return (
        reply.successful,
        reply.failure_reason,
        description.type_name,
        [(f.name, f.type.type_id, f.type.nested_type_name, f.default_value) for f in description.fields],
        sorted(one.type_name for one in reply.type_description.referenced_type_descriptions),
        len(reply.type_sources),
        len(reply.extra_information),
    )


HASH_OF_STRING = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
lines(
    "type",
    disabled=lambda: types_of(
        {"parameter_overrides": [Parameter("start_type_description_service", value=False)]},
        GetTypeDescription.Request(),
    ),
    no_hash=lambda: described(type_name="std_msgs/msg/String"),
    bad_hash=lambda: described(type_name="std_msgs/msg/String", type_hash="abc"),
    other_hash=lambda: described(type_name="std_msgs/msg/String", type_hash="RIHS01_" + "0" * 64),
    parameter=lambda: Node("n").get_parameter("start_type_description_service").value,
    descriptor=lambda: Node("n").describe_parameter("start_type_description_service").read_only,
    overridden=lambda: (
        Node("n", parameter_overrides=[Parameter("start_type_description_service", value=False)])
        .get_parameter("start_type_description_service")
        .value
    ),
    wrong=lambda: outcome(
        Node, "n", parameter_overrides=[Parameter("start_type_description_service", value="no")]
    ),
    service_names=lambda: sorted(
        name for name, _ in Node("n").get_service_names_and_types_by_node("n", "/") if "type" in name
    ),
    hash=lambda: next(
        str(info.topic_type_hash)
        for info in (lambda n, p: n.get_publishers_info_by_topic("t"))(
            *(lambda n: (n, n.create_publisher(String, "t", 1)))(Node("n"))
        )
    ),
)


class Managed(LifecycleNode):
    """A lifecycle node with a publisher that logs its transitions."""

    def __init__(self) -> None:
        super().__init__("m")
        self.log: list[Any] = []
        self.managed = self.create_lifecycle_publisher(String, "t", 10)

    def on_configure(self, state: Any) -> Any:
        self.log.append(("configure", state.label))
        return super().on_configure(state)

    def on_activate(self, state: Any) -> Any:
        self.log.append(("activate", state.label, self.managed.is_activated))
        return super().on_activate(state)

    def on_deactivate(self, state: Any) -> Any:
        self.log.append(("deactivate", state.label, self.managed.is_activated))
        return super().on_deactivate(state)

    def on_cleanup(self, state: Any) -> Any:
        self.log.append(("cleanup", state.label))
        return super().on_cleanup(state)


def lived(*names: str) -> Any:
    node = Managed()
    received: list[str] = []
    node.create_subscription(String, "t", lambda m: received.append(m.data), 10)
    results = []
    for name in names:
        results.append(outcome(getattr(node, f"trigger_{name}")))
        node.managed.publish(String(data=name))
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    end = time.monotonic() + 0.4
    while time.monotonic() < end:
        executor.spin_once(timeout_sec=0.05)
    executor.shutdown()
    return results, node.log, received, node.managed.is_activated


def lifecycle_service(kind: Any, name: str, request: Any, *triggers: str) -> Any:
    node = Managed()
    for trigger in triggers:
        getattr(node, f"trigger_{trigger}")()
    return response(node, kind, f"/m/{name}", request)


def change(number: int, label: str = "", *triggers: str) -> Any:
    request = ChangeState.Request()
    request.transition.id, request.transition.label = number, label
    return lifecycle_service(ChangeState, "change_state", request, *triggers).success


lines(
    "managed",
    whole_life=lambda: lived("configure", "activate", "deactivate", "cleanup", "shutdown"),
    activated_too_early=lambda: lived("activate"),
    twice=lambda: lived("configure", "configure"),
    to_the_end=lambda: lived("configure", "shutdown", "configure"),
    state=lambda: lifecycle_service(GetState, "get_state", GetState.Request(), "configure").current_state,
    states=lambda: [
        (one.id, one.label)
        for one in lifecycle_service(
            GetAvailableStates, "get_available_states", GetAvailableStates.Request()
        ).available_states
    ],
    transitions=lambda: [
        (one.transition.id, one.transition.label, one.start_state.label, one.goal_state.label)
        for one in lifecycle_service(
            GetAvailableTransitions,
            "get_available_transitions",
            GetAvailableTransitions.Request(),
            "configure",
        ).available_transitions
    ],
    graph=lambda: len(
        lifecycle_service(
            GetAvailableTransitions, "get_transition_graph", GetAvailableTransitions.Request()
        ).available_transitions
    ),
    change=lambda: change(1),
    change_by_label=lambda: change(0, "configure"),
    change_unknown_label=lambda: change(0, "nothing"),
    change_impossible=lambda: change(3),
    change_unknown=lambda: change(77),
    change_after=lambda: change(3, "", "configure"),
    returns=lambda: list(TransitionCallbackReturn),
    primary_states=lambda: [StateMessage.PRIMARY_STATE_UNKNOWN, StateMessage.PRIMARY_STATE_FINALIZED],
)


def with_client(call: Any) -> Any:
    node = Node("n")
    node.create_service(SetBool, "b", lambda q, r: setattr(r, "success", q.data) or r)
    client = node.create_client(SetBool, "b")
    return call(node, client)


def called(node: Any, client: Any, request: Any, executor: Any = None) -> Any:
    future = client.call_async(request)
    executor = executor or SingleThreadedExecutor()
    rclpy.spin_until_future_complete(node, future, executor, 3.0)
    return future.done(), future.result(), future.exception()


def removed_request(node: Any, client: Any) -> Any:
    future = client.call_async(SetBool.Request())
    client.remove_pending_request(future)
    rclpy.spin_until_future_complete(node, future, timeout_sec=0.4)
    return future.done(), future.cancelled()


def raising_server() -> Any:
    node = Node("n")

    def serve(request: Any, response: Any) -> Any:
        raise ValueError("in the server")

    node.create_service(Trigger, "t", serve)
    future = node.create_client(Trigger, "t").call_async(Trigger.Request())
    return outcome(rclpy.spin_until_future_complete, node, future, None, 2.0), future.done()


def async_server() -> Any:
    node = Node("n")

    async def serve(request: Any, response: Any) -> Any:
        response.message = "async"
        return response

    node.create_service(Trigger, "t", serve)
    return called(node, node.create_client(Trigger, "t"), Trigger.Request())


def two_clients() -> Any:
    node = Node("n")
    node.create_service(SetBool, "b", lambda q, r: setattr(r, "success", q.data) or r)
    one, two = (node.create_client(SetBool, "b") for _ in range(2))
    futures = [one.call_async(SetBool.Request(data=True)), two.call_async(SetBool.Request(data=False))]
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    for future in futures:
        executor.spin_until_future_complete(future, 3.0)
    executor.shutdown()
    return [future.result().success for future in futures]


def done_callbacks(node: Any, client: Any) -> Any:
    log: list[Any] = []
    future = client.call_async(SetBool.Request(data=True))
    future.add_done_callback(lambda f: log.append(("first", f.result().success)))
    future.add_done_callback(lambda f: log.append("second"))
    rclpy.spin_until_future_complete(node, future, timeout_sec=3.0)
    end = time.monotonic() + 1.0
    while len(log) < 2 and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.05)
    future.add_done_callback(lambda f: log.append("late"))
    return log


lines(
    "call",
    plain=lambda: with_client(lambda n, c: called(n, c, SetBool.Request(data=True))),
    wrong_request=lambda: with_client(lambda n, c: outcome(c.call_async, Trigger.Request())),
    class_as_request=lambda: with_client(lambda n, c: outcome(c.call_async, SetBool.Request)),
    response_as_request=lambda: with_client(lambda n, c: outcome(c.call_async, SetBool.Response())),
    nothing=lambda: with_client(lambda n, c: outcome(c.call_async, None)),
    removed=lambda: with_client(removed_request),
    raising=raising_server,
    async_server=async_server,
    two_clients=two_clients,
    done_callbacks=lambda: with_client(done_callbacks),
    ready=lambda: with_client(lambda n, c: (c.service_is_ready(), c.wait_for_service(0.1), c.srv_name)),
    missing=lambda: Node("n").create_client(SetBool, "none").wait_for_service(timeout_sec=0.3),
    name_of_service=lambda: Node("n", namespace="/ns").create_service(SetBool, "~/b", print).srv_name,
    destroyed=lambda: with_client(
        lambda n, c: (n.destroy_client(c), outcome(c.call_async, SetBool.Request()))
    ),
    text=lambda: with_client(lambda n, c: (c.srv_type.__name__, type(c.qos_profile).__name__)),
)


def defaults(package: str, kind: str) -> Any:
    """Return the text of each message of a package with its default values."""
    module = importlib.import_module(f"{package}.{kind}")
    classes = [getattr(module, name) for name in sorted(dir(module)) if name[0].isupper()]
    if kind == "srv":
        classes = [part for one in classes if hasattr(one, "Request") for part in (one.Request, one.Response)]
    text = "\n".join(f"{one()!r} {sorted(one.get_fields_and_field_types().items())}" for one in classes)
    return len(classes), hashlib.sha256(text.encode()).hexdigest()[:16]


def constants(package: str) -> Any:
    """Return a digest of the constants of the messages of a package."""
    module = importlib.import_module(f"{package}.msg")
    rows = [
        (name, constant, getattr(getattr(module, name), constant))
        for name in sorted(dir(module))
        if name[0].isupper()
        for constant in sorted(dir(getattr(module, name)))
        if constant.isupper() and constant[0] != "_" and constant not in ("SLOT_TYPES", "TYPE_SUPPORT")
    ]
    return len(rows), hashlib.sha256(repr(rows).encode()).hexdigest()[:16]


PACKAGES = (
    "builtin_interfaces std_msgs geometry_msgs sensor_msgs nav_msgs visualization_msgs diagnostic_msgs "
)
PACKAGES += "trajectory_msgs shape_msgs stereo_msgs action_msgs lifecycle_msgs rcl_interfaces rosgraph_msgs"
SERVICES = "std_srvs sensor_msgs nav_msgs diagnostic_msgs lifecycle_msgs rcl_interfaces"
lines("defaults", **{name: partial(defaults, name, "msg") for name in PACKAGES.split()})
lines("defaults_of_services", **{name: partial(defaults, name, "srv") for name in SERVICES.split()})
lines("constants", **{name: partial(constants, name) for name in PACKAGES.split()})
lines(
    "subscribe",
    content_filter=lambda: outcome(
        Node("n").create_subscription, String, "t", print, 10, content_filter_options=None
    ),
    no_callback=lambda: outcome(Node("n").create_subscription, String, "t", None, 10),
    three_arguments=lambda: outcome(Node("n").create_subscription, String, "t", lambda a, b, c: None, 10),
    no_arguments=lambda: outcome(Node("n").create_subscription, String, "t", lambda: None, 10),
    qos_text=lambda: outcome(Node("n").create_subscription, String, "t", print, "10"),
    qos_negative=lambda: outcome(Node("n").create_subscription, String, "t", print, -1),
    message_instance=lambda: outcome(lambda: Node("n").create_subscription(String(), "t", print, 10).topic),
    topic=lambda: Node("n", namespace="/a").create_subscription(String, "~/t", print, 10).topic_name,
    keyword=lambda: (
        Node("n")
        .create_subscription(msg_type=String, topic="t", callback=print, qos_profile=10)
        .qos_profile.depth
    ),
    publishers=lambda: (lambda n: (n.create_publisher(String, "t", 1), n.count_publishers("t"))[1])(
        Node("n")
    ),
    wait_for_acked=lambda: Node("n").create_publisher(String, "t", 1).wait_for_all_acked(Duration(seconds=1)),
    publish_wrong=lambda: outcome(Node("n").create_publisher(String, "t", 1).publish, Int32()),
    publish_class=lambda: outcome(Node("n").create_publisher(String, "t", 1).publish, String),
    publish_text=lambda: outcome(Node("n").create_publisher(String, "t", 1).publish, "a"),
    publish_none=lambda: outcome(Node("n").create_publisher(String, "t", 1).publish, None),
    logger_name=lambda: Node("n", namespace="/a").create_publisher(String, "t", 1).logger_name,
    destroy_twice=lambda: (lambda n, p: (n.destroy_publisher(p), n.destroy_publisher(p)))(
        *(lambda n: (n, n.create_publisher(String, "t", 1)))(Node("n"))
    ),
)
lines(
    "enumeration",
    numbers=lambda: [int(TransitionCallbackReturn.SUCCESS), int(QoSCompatibility.ERROR)],
    equal=lambda: [TransitionCallbackReturn.SUCCESS == 97, QoSCompatibility.ERROR == 2],
    text=lambda: [str(TransitionCallbackReturn.SUCCESS), str(QoSCompatibility.OK), f"{QoSCompatibility.OK}"],
    names=lambda: [list(TransitionCallbackReturn.__members__), QoSCompatibility(1).name],
    list=lambda: len(list(QoSCompatibility)),
    item=lambda: QoSCompatibility["x"],
)
if __name__ == "__main__":
    main()
