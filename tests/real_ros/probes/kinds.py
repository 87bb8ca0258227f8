# mypy: ignore-errors
"""Arguments of another kind than the documentation says: numbers, text, classes, messages and nothing.

Each call gets the same values. Most of these calls are wrong on purpose.
"""

from typing import Any

import numpy as np
import rclpy
from geometry_msgs.msg import Point
from lifecycle_msgs.msg import State
from probing import Fibonacci, lines, main, outcome
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.action import ActionServer
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.logging import (
    get_logger,
    get_logger_effective_level,
    get_logging_severity_from_string,
    set_logger_level,
)
from rclpy.node import Node
from rclpy.parameter import Parameter, get_parameter_value
from rclpy.parameter_client import AsyncParameterClient
from rclpy.qos import HistoryPolicy, QoSProfile
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.task import Future
from rclpy.time import Time
from rclpy.wait_for_message import wait_for_message
from std_msgs.msg import Int32, String
from std_srvs.srv import SetBool, Trigger
from visualization_msgs.msg import Marker


class _Plain:
    pass


VALUES = {
    "nothing": None,
    "zero": 0,
    "one": 1,
    "real": 1.5,
    "text": "x",
    "empty": "",
    "a_list": ["a"],
    "a_tuple": ("a",),
    "an_object": _Plain(),
    "a_class": _Plain,
    "a_message": String(data="x"),
    "a_type": String,
    "a_service": Trigger,
    "numpy_int": np.int64(1),
    "a_duration": Duration(seconds=1),
}


def _node(**options: Any) -> Node:
    return Node("n", **options)


def _executor_of(value: Any) -> str:
    rclpy.spin_once(_node(), executor=value, timeout_sec=0.0)
    return "spun"


CALLS = {
    "publisher_type": lambda value: _node().create_publisher(value, "t", 1).msg_type,
    "publisher_events": lambda value: (
        type(_node().create_publisher(String, "t", 1, event_callbacks=value)).__name__
    ),
    "subscription_type": lambda value: _node().create_subscription(value, "t", print, 1).msg_type,
    "subscription_group": lambda value: (
        type(_node().create_subscription(String, "t", print, 1, callback_group=value)).__name__
    ),
    "service_type": lambda value: _node().create_service(value, "s", print).srv_type,
    "service_group": lambda value: (
        type(_node().create_service(Trigger, "s", print, callback_group=value)).__name__
    ),
    "client_group": lambda value: type(_node().create_client(Trigger, "s", callback_group=value)).__name__,
    "timer_clock": lambda value: type(_node().create_timer(1.0, print, clock=value)).__name__,
    "timer_group": lambda value: type(_node().create_timer(1.0, print, value)).__name__,
    "timer_autostart": lambda value: _node().create_timer(1.0, print, autostart=value).is_canceled(),
    "guard_group": lambda value: type(_node().create_guard_condition(print, value)).__name__,
    "node_arguments": lambda value: _node(cli_args=value).get_name(),
    "node_global": lambda value: _node(use_global_arguments=value).get_name(),
    "node_rosout": lambda value: _node(enable_rosout=value).get_name(),
    "node_overrides": lambda value: _node(parameter_overrides=value).get_name(),
    "destroy_rate": lambda value: _node().destroy_rate(value),
    "names_of_node": lambda value: _node().get_publisher_names_and_types_by_node(value, "/"),
    "names_in_namespace": lambda value: _node().get_publisher_names_and_types_by_node("n", value),
    "info_no_mangle": lambda value: _node().get_publishers_info_by_topic("x", value),
    "wait_for_node": lambda value: _node().wait_for_node(value, 0.01),
    "wait_for_node_seconds": lambda value: _node().wait_for_node("n", value),
    "descriptor": lambda value: _node().declare_parameter("a", 1, value).value,
    "get_parameter_or": lambda value: _node().get_parameter_or("a", value),
    "parameter_types": lambda value: _node().get_parameter_types(value),
    "by_prefix": lambda value: len(_node().get_parameters_by_prefix(value)),
    "list_prefixes": lambda value: _node().list_parameters(value, 0).names,
    "pre_set_callback": lambda value: _node().add_pre_set_parameters_callback(value),
    "set_parameters": lambda value: _node().set_parameters(value),
    "spin_once_executor": _executor_of,
    "ok": lambda value: bool(rclpy.ok(context=value)) if not value else None,
    "overridden_policies": lambda value: type(QoSOverridingOptions(value)).__name__,
    "acknowledged": lambda value: _node().create_publisher(String, "t", 1).wait_for_all_acked(value),
    "result_timeout": lambda value: (
        type(ActionServer(_node(), Fibonacci, "a", print, result_timeout=value)).__name__
    ),
    "effective_level": lambda value: get_logger_effective_level(value).name,
    "severity": lambda value: get_logging_severity_from_string(value),
    "level_of": lambda value: set_logger_level(value, 10),
    "logger_name": lambda value: get_logger("a").debug("x", name=value),
    "wait_for_message_type": lambda value: wait_for_message(value, _node(), "t", time_to_wait=0.01)[0],
    "set_by_client": lambda value: type(AsyncParameterClient(_node(), "x").set_parameters(value)).__name__,
    "serialized": lambda value: type(serialize_message(value)).__name__,
    "time": lambda value: Time(seconds=value).nanoseconds,
    "compared": lambda value: Duration(seconds=1) < value,
    "multiplied": lambda value: Duration(seconds=1) * value,
    "prefixed": lambda value: _node().describe_parameters(value),
    "awaited_seconds": lambda value: SingleThreadedExecutor().spin_once(value) if value == 0 else None,
    "parameter": lambda value: Parameter("a", value=value).type_.name,
}
for _name, _call in CALLS.items():
    lines(_name, **{kind: (lambda call=_call, value=value: call(value)) for kind, value in VALUES.items()})


def _received_by_an_instance() -> Any:
    node, received = _node(), []
    publisher = node.create_publisher(Int32, "t", 1)
    node.create_subscription(Int32(), "t", lambda message: received.append(message.data), 1)
    publisher.publish(Int32(data=7))
    for _ in range(20):
        rclpy.spin_once(node, timeout_sec=0.05)
        if received:
            break
    return received


lines(
    "instance",
    published=lambda: _node().create_publisher(Int32(), "t", 1).publish(Int32()),
    bytes_published=lambda: _node().create_publisher(Int32(), "t", 1).publish(b""),
    received=_received_by_an_instance,
    as_client=lambda: _node().create_client(SetBool.Request(), "s"),
    deserialized=lambda: deserialize_message(serialize_message(Int32(data=3)), Int32()),
)


class _Mine(Point):
    pass


lines(
    "class",
    iterated=lambda: list(Point),
    length=lambda: len(Point),
    multiplied=lambda: Point * 2,
    added=lambda: Point.x + 1,
    compared=lambda: Point < Point,
    negated=lambda: -Point,
    contains=lambda: 1 in Point,
    as_int=lambda: int(Point),
    constant=lambda: setattr(Marker, "CUBE", 1),
    constant_of_an_object=lambda: setattr(Marker(), "CUBE", 1),
    constant_deleted=lambda: delattr(Marker, "CUBE"),
    default_assigned=lambda: setattr(ParameterDescriptor, "DYNAMIC_TYPING__DEFAULT", 1),
    constants=lambda: [Marker.CUBE, Marker().CUBE, State.TRANSITION_STATE_CONFIGURING],
    metaclasses=lambda: [type(kind).__name__ for kind in (Point, Trigger, Trigger.Request)],
    of_a_subclass=lambda: [repr(_Mine(x=1.0)), _Mine(x=1.0) == _Mine(x=1.0), type(_Mine).__name__],
    service_created=lambda: SetBool(),
    service_with_a_value=lambda: SetBool(True),
    service_with_a_field=lambda: SetBool(data=True),
    request_with_a_value=lambda: SetBool.Request(True),
)
lines(
    "name",
    as_bytes=lambda: _node().create_publisher(String, b"t", 1).topic,
    of_dds=lambda: any(
        name.startswith("rt/") for name, _ in _node().get_topic_names_and_types(no_demangle=True)
    ),
)
_KEEP_ALL = {"depth": -1, "history": HistoryPolicy.KEEP_ALL}
lines(
    "negative_depth",
    publisher=lambda: _node().create_publisher(String, "t", QoSProfile(depth=-1)),
    subscription=lambda: _node().create_subscription(String, "t", print, QoSProfile(depth=-1)),
    client=lambda: _node().create_client(SetBool, "s", qos_profile=QoSProfile(depth=-1)),
    service=lambda: _node().create_service(SetBool, "s", print, qos_profile=QoSProfile(depth=-1)),
    keep_all=lambda: _node().create_publisher(String, "t", QoSProfile(**_KEEP_ALL)),
)
lines(
    "given",
    too_large=lambda: outcome(get_parameter_value, "1e400"),
    braces=lambda: _node(cli_args=["--ros-args", "-r", "{node}/t:=u"]),
    is_done=lambda: (lambda future: (future.set_result(None), future.done()))(Future()),
)

if __name__ == "__main__":
    main()
