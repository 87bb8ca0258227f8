# mypy: ignore-errors
"""Unusual input that the real rclpy accepts or rejects, and the string form of messages.

Many of the calls are wrong on purpose.
"""

import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import rclpy
from geometry_msgs.msg import Point, PoseWithCovariance
from probing import lines, main, outcome
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import ByteMultiArray, Float64MultiArray, Int32, Int64MultiArray, String, UInt8MultiArray
from std_srvs.srv import Trigger
from visualization_msgs.msg import Marker


def _until(ready: Any, node: Any, limit: Any = 5.0) -> Any:
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    end = time.monotonic() + limit
    while not ready() and time.monotonic() < end:
        executor.spin_once(timeout_sec=0.02)
    executor.remove_node(node)


def _sent(message: Any) -> Any:
    """Return a message after serialization and deserialization."""
    return outcome(lambda: deserialize_message(serialize_message(message), type(message)))


def _covariance(value: Any) -> Any:
    message = PoseWithCovariance()
    message.covariance = value
    return list(message.covariance)[:8]


def _kept(publisher: Any, subscription: Any) -> Any:
    node, seen = Node("n"), []
    sender = node.create_publisher(Int32, "t", publisher)
    sender.publish(Int32(data=1))
    node.create_subscription(Int32, "t", lambda m: seen.append(m.data), subscription)
    _until(lambda: False, node, limit=0.4)
    return seen


def _node_with(text: Any, *more: Any) -> Any:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "p.yaml")
        file.write_text(text)
        node = Node("n", cli_args=["--ros-args", "--params-file", str(file), *more])
    node.declare_parameter("a", 0)
    return node.get_parameter("a").value


def _remapped(*rules: Any) -> Any:
    node = Node("n", cli_args=["--ros-args", *(word for rule in rules for word in ("-r", rule))])
    return [node.resolve_topic_name("a"), node.resolve_service_name("a"), node.get_fully_qualified_name()]


def _given(*values: Any) -> Any:
    words = [word for value in values for word in ("-p", value)]
    node = Node("n", cli_args=["--ros-args", *words], automatically_declare_parameters_from_overrides=True)
    return sorted(
        (name, p.value) for name, p in node.get_parameters_by_prefix("").items() if "_t" not in name
    )


def _bad_bytes(data: Any) -> Any:
    node = Node("n")
    publisher = node.create_publisher(String, "t", 10)
    node.create_subscription(String, "t", print, 10)
    _until(lambda: publisher.get_subscription_count() == 1, node)
    return [outcome(publisher.publish, data), outcome(_until, lambda: False, node, 0.3)]


_OTHER = {"durability": DurabilityPolicy.TRANSIENT_LOCAL}
lines(
    "corner",
    on_shutdown_number=lambda: rclpy.get_default_context().on_shutdown(3),
    on_set_none=lambda: Node("n").add_on_set_parameters_callback(None),
    list_depth_negative=lambda: Node("n").list_parameters([], -1),
    list_depth_text=lambda: Node("n").list_parameters([], "1"),
    list_prefix_text=lambda: Node("n").list_parameters("a", 0),
    constant_of_an_object=lambda: setattr(Marker(), "CUBE", 7),
    constant_of_the_class=lambda: setattr(Marker, "CUBE", 7),
    constant=lambda: Marker.CUBE,
    attribute_of_the_class=lambda: setattr(Marker, "MY_OWN", 7),
    unknown_reliability=lambda: Node("n").create_publisher(
        Int32, "t", QoSProfile(depth=1, reliability=ReliabilityPolicy.UNKNOWN)
    ),
    unknown_history=lambda: Node("n").create_publisher(
        Int32, "t", QoSProfile(depth=1, history=HistoryPolicy.UNKNOWN)
    ),
    unknown_durability=lambda: Node("n").create_subscription(
        Int32, "t", print, QoSProfile(depth=1, durability=DurabilityPolicy.UNKNOWN)
    ),
    unknown_liveliness=lambda: Node("n").create_subscription(
        Int32, "t", print, QoSProfile(depth=1, liveliness=LivelinessPolicy.UNKNOWN)
    ),
    default_durability=lambda: _kept(
        QoSProfile(depth=1, durability=DurabilityPolicy.SYSTEM_DEFAULT), QoSProfile(depth=1, **_OTHER)
    ),
    default_durability_asked=lambda: _kept(
        QoSProfile(depth=1, **_OTHER), QoSProfile(depth=1, durability=DurabilityPolicy.SYSTEM_DEFAULT)
    ),
    zero_in_a_string=lambda: _sent(String(data="a\0b")),
    surrogate=lambda: _sent(String(data="\ud800")),
    emoji=lambda: _sent(String(data="🤖")),
    long_string=lambda: len(_sent(String(data="x" * 100_000))),
    matrix_as_covariance=lambda: _covariance(np.eye(6)),
    flat_matrix=lambda: _covariance(np.eye(6).flatten()),
    float32_covariance=lambda: _covariance(np.zeros(36, dtype=np.float32)),
    list_covariance=lambda: _covariance([1.0] * 36),
    int_covariance=lambda: _covariance([1] * 36),
    range_covariance=lambda: _covariance(range(36)),
    wait_when_shut_down=lambda: _wait_when_shut_down(),
    bad_bytes=lambda: _bad_bytes(b"x"),
    no_bytes=lambda: _bad_bytes(b""),
    deserialize_nothing=lambda: deserialize_message(b"", String),
    deserialize_short=lambda: deserialize_message(b"\0\1\0\0\5\0\0\0a", String),
    deserialize_text=lambda: deserialize_message("x", String),
    deserialize_wrong_class=lambda: deserialize_message(b"\0\1\0\0\1\0\0\0\0", int),
    serialize_wrong=lambda: serialize_message(3),
    serialize_class=lambda: serialize_message(String),
    serialized=lambda: serialize_message(String(data="a")),
    prints_int64=lambda: str(Int64MultiArray(data=[0])),
    prints_float64=lambda: str(Float64MultiArray(data=[0.5])),
    prints_bytes=lambda: str(UInt8MultiArray(data=[1, 2])),
    prints_byte=lambda: str(ByteMultiArray(data=[b"a"])),
    prints_point=lambda: str(Point(x=1.0)),
    type_of_bytes=lambda: type(UInt8MultiArray(data=b"ab").data).__name__,
    slots=lambda: Point.__slots__,
    fields=lambda: Point.get_fields_and_field_types(),
    slot_types=lambda: [type(one).__name__ for one in Marker.SLOT_TYPES],
    slot_names=lambda: [one.typename for one in Point.SLOT_TYPES],
    slot_of_an_object=lambda: len(Point().SLOT_TYPES),
    slot_namespaced=lambda: [Marker.SLOT_TYPES[0].namespaces, Marker.SLOT_TYPES[0].name],
    slot_namespaced_name=lambda: PoseWithCovariance.SLOT_TYPES[0].namespaced_name(),
    slot_array=lambda: [
        PoseWithCovariance.SLOT_TYPES[1].size,
        PoseWithCovariance.SLOT_TYPES[1].value_type.typename,
    ],
    slot_sequence=lambda: Float64MultiArray.SLOT_TYPES[1].value_type.typename,
    slot_bound=lambda: Float64MultiArray.SLOT_TYPES[1].has_maximum_size(),
    slot_request=lambda: len(Trigger.Response.SLOT_TYPES),
    event_class=lambda: Trigger.Event.__name__,
)
lines(
    "file",
    empty=lambda: _node_with(""),
    comment=lambda: _node_with("# nothing\n"),
    two_documents=lambda: _node_with(
        "/n:\n  ros__parameters:\n    a: 1\n---\n/n:\n  ros__parameters:\n    a: 2\n"
    ),
    plain=lambda: _node_with("/n:\n  ros__parameters:\n    a: 1\n"),
    wildcard=lambda: _node_with("/**:\n  ros__parameters:\n    a: 1\n"),
    short=lambda: _node_with("n:\n  ros__parameters:\n    a: 1\n"),
    other_node=lambda: _node_with("/m:\n  ros__parameters:\n    a: 1\n"),
    no_parameters=lambda: _node_with("/n:\n  a: 1\n"),
    tab=lambda: _node_with("/n:\n\tros__parameters:\n"),
    wrong_type=lambda: _node_with("/n:\n  ros__parameters:\n    a: text\n"),
    argument_wins=lambda: _node_with("/n:\n  ros__parameters:\n    a: 1\n", "-p", "a:=2"),
    empty_parameters=lambda: _node_with("/n:\n  ros__parameters:\n"),
    dash=lambda: _node_with("/n:\n  ros__parameters:\n    a-b: 1\n"),
    null=lambda: _node_with("/n:\n  ros__parameters:\n    a: null\n"),
)
lines(
    "remap",
    topic=lambda: _remapped("a:=b"),
    absolute=lambda: _remapped("/a:=/b"),
    private=lambda: _remapped("a:=~/b"),
    from_private=lambda: _remapped("~/a:=b"),
    node=lambda: _remapped("__node:=m"),
    name=lambda: _remapped("__name:=m"),
    namespace=lambda: _remapped("__ns:=/x"),
    namespace_relative=lambda: _remapped("__ns:=x"),
    of_node=lambda: _remapped("n:a:=b"),
    of_other_node=lambda: _remapped("m:a:=b"),
    rostopic=lambda: _remapped("rostopic://a:=b"),
    rosservice=lambda: _remapped("rosservice://a:=b"),
    first_wins=lambda: _remapped("a:=b", "a:=c"),
    not_chained=lambda: _remapped("a:=b", "b:=c"),
    no_target=lambda: _remapped("a:="),
    no_source=lambda: _remapped(":=b"),
    one_colon=lambda: _remapped("a:b"),
    space=lambda: _remapped("a b:=c"),
    bad_target=lambda: _remapped("a:=b c"),
    wildcard=lambda: _remapped("**:=c"),
    bad_node=lambda: _remapped("__node:=a b"),
)
lines(
    "given",
    int=lambda: _given("a:=1"),
    float=lambda: _given("a:=1.0"),
    text=lambda: _given("a:=x"),
    quoted=lambda: _given("a:='1'"),
    bool=lambda: _given("a:=true"),
    list=lambda: _given("a:=[1, 2]"),
    mixed=lambda: _given("a:=[1, x]"),
    empty_list=lambda: _given("a:=[]"),
    empty=lambda: _given("a:="),
    exponent=lambda: _given("a:=1e3"),
    hexadecimal=lambda: _given("a:=0x10"),
    of_node=lambda: _given("n:a:=1"),
    of_other_node=lambda: _given("m:a:=1"),
    twice=lambda: _given("a:=1", "a:=2"),
    dots=lambda: _given("a.b:=1"),
    dash=lambda: _given("a-b:=1"),
    slash=lambda: _given("a/b:=1"),
    space=lambda: _given("a b:=1"),
    no_value=lambda: _given("a"),
    one_colon=lambda: _given("a:1"),
    mapping=lambda: _given("a:={b: 1}"),
    null=lambda: _given("a:=null"),
    infinite=lambda: _given("a:=.inf"),
    digit=lambda: _given("1a:=1"),
)


def _args(*words: Any) -> Any:
    node = Node("n", cli_args=list(words))
    return node.get_fully_qualified_name()


lines(
    "args",
    nothing=lambda: _args(),
    ordinary=lambda: _args("a", "-b", "--c"),
    flag_alone=lambda: _args("--ros-args"),
    ended=lambda: _args("--ros-args", "-r", "__node:=m", "--", "x"),
    unknown=lambda: _args("--ros-args", "--nothing"),
    missing_value=lambda: _args("--ros-args", "-r"),
    missing_parameter=lambda: _args("--ros-args", "-p"),
    missing_file=lambda: _args("--ros-args", "--params-file"),
    no_such_file=lambda: _args("--ros-args", "--params-file", "/nowhere/x.yaml"),
    bad_level=lambda: _args("--ros-args", "--log-level", "loud"),
    level=lambda: _args("--ros-args", "--log-level", "debug"),
    level_of_logger=lambda: _args("--ros-args", "--log-level", "n:=debug"),
    twice=lambda: _args("--ros-args", "-r", "__node:=m", "--ros-args", "-r", "__ns:=/x"),
    number=lambda: Node("n", cli_args=[1]),
    text=lambda: Node("n", cli_args="x").get_name(),
)


def _wait_when_shut_down() -> Any:
    client = Node("n").create_client(Trigger, "nobody")
    rclpy.shutdown()
    return outcome(client.wait_for_service, 1.0)


if __name__ == "__main__":
    main()
