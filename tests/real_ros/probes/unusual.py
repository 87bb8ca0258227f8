# mypy: ignore-errors
"""Unusual use of ordinary objects: arrays, bounds, arithmetic, and destroyed clients.

Many of the calls are wrong on purpose.
"""

import array
import copy
import pickle
import signal
import time
from typing import Any

import numpy as np
import rclpy
from builtin_interfaces.msg import Duration as DurationMessage
from builtin_interfaces.msg import Time as TimeMessage
from diagnostic_msgs.msg import DiagnosticStatus, KeyValue
from geometry_msgs.msg import Point, Polygon, PoseWithCovariance, Twist
from nav_msgs.msg import OccupancyGrid, Path
from probing import Fibonacci, lines, main, outcome, probe
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterType,
    ParameterValue,
)
from rcl_interfaces.msg import Parameter as ParameterMessage
from rclpy.action import ActionClient, ActionServer
from rclpy.clock import Clock, ClockType
from rclpy.context import Context
from rclpy.duration import Duration, Infinite
from rclpy.guard_condition import GuardCondition
from rclpy.logging import LoggingSeverity, get_logger
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_value_to_python
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSCompatibility,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
    qos_check_compatible,
    qos_profile_sensor_data,
)
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.time import Time
from rclpy.validate_full_topic_name import validate_full_topic_name
from rclpy.validate_namespace import validate_namespace
from rclpy.validate_node_name import validate_node_name
from rclpy.validate_parameter_name import validate_parameter_name
from rclpy.validate_topic_name import validate_topic_name
from sensor_msgs.msg import CameraInfo, Image, JointState, LaserScan, PointCloud2
from std_msgs.msg import (
    ByteMultiArray,
    Float32,
    Float64MultiArray,
    Header,
    Int8MultiArray,
    String,
    UInt8MultiArray,
)
from std_srvs.srv import SetBool, Trigger

_kept: list[Any] = []


def _node(**options: Any) -> Node:
    node = Node("n", **options)
    _kept.append(node)
    return node


def _array(kind: Any, field: str, value: Any) -> Any:
    message = kind()
    setattr(message, field, value)
    read = getattr(message, field)
    return (
        type(read).__name__,
        getattr(read, "typecode", getattr(read, "dtype", None)),
        list(read)[:5],
    )


lines(
    "array",
    of_bytes=lambda: _array(UInt8MultiArray, "data", b"\x01\xff"),
    of_bytearray=lambda: _array(UInt8MultiArray, "data", bytearray(b"\x01\xff")),
    of_memoryview=lambda: _array(UInt8MultiArray, "data", memoryview(b"\x01")),
    of_array_b=lambda: _array(Int8MultiArray, "data", array.array("b", [-1, 2])),
    of_numpy_uint8=lambda: _array(UInt8MultiArray, "data", np.array([1, 2], np.uint8)),
    of_numpy_float=lambda: _array(Float64MultiArray, "data", np.array([1.0, 2.0])),
    of_numpy_float32=lambda: _array(Float64MultiArray, "data", np.array([1.0, 2.5], np.float32)),
    of_numpy_int=lambda: _array(Float64MultiArray, "data", np.array([1, 2])),
    of_numpy_empty=lambda: _array(Float64MultiArray, "data", np.array([])),
    of_array_d=lambda: _array(Float64MultiArray, "data", array.array("d", [1.5])),
    of_ints=lambda: _array(Float64MultiArray, "data", [1, 2]),
    of_range=lambda: _array(OccupancyGrid, "data", range(3)),
    of_set=lambda: _array(JointState, "name", {"a"}),
    of_names=lambda: _array(JointState, "name", ("a", "b")),
    of_deque=lambda: _array(JointState, "position", __import__("collections").deque([1.0, 2.0])),
    covariance_of_numpy=lambda: _array(PoseWithCovariance, "covariance", np.arange(36.0)),
    covariance_of_list=lambda: _array(PoseWithCovariance, "covariance", [0.0] * 36),
    intrinsics=lambda: _array(CameraInfo, "k", [1.0] * 9),
    intrinsics_of_ints=lambda: _array(CameraInfo, "k", [1] * 9),
    distortion_of_numpy=lambda: _array(CameraInfo, "d", np.zeros(5)),
    strided=lambda: _array(Float64MultiArray, "data", np.arange(6.0)[::2]),
    default_of_covariance=lambda: _array(
        PoseWithCovariance,
        "covariance",
        PoseWithCovariance().covariance,
    ),
    default_is_shared=lambda: JointState().position is JointState().position,
    bytes_of_byte_array=lambda: _array(ByteMultiArray, "data", [b"\x01", b"\x02"]),
)
lines(
    "equality",
    array_and_list=lambda: (JointState(position=[1.0]) == JointState(position=array.array("d", [1.0])),),
    nan=lambda: Point(x=float("nan")) == Point(x=float("nan")),
    same_nan=lambda: (lambda point: point == copy.copy(point))(Point(x=float("nan"))),
    zero_signs=lambda: Point(x=0.0) == Point(x=-0.0),
    other_class=lambda: Point() == Twist().linear,
    text=lambda: String() == "",
    none=lambda: String() == None,  # noqa: E711
    covariance=lambda: PoseWithCovariance() == PoseWithCovariance(),
    covariance_differs=lambda: (PoseWithCovariance() == PoseWithCovariance(covariance=np.ones(36)),),
    nested=lambda: Path(header=Header(frame_id="a")) == Path(header=Header(frame_id="a")),
    not_equal=lambda: String(data="a") != String(data="b"),
    copied=lambda: copy.deepcopy(JointState(position=[1.0])) == JointState(position=[1.0]),
    shallow=lambda: (lambda message: copy.copy(message).header is message.header)(JointState()),
    pickled=lambda: pickle.loads(pickle.dumps(JointState(name=["a"]))) == JointState(name=["a"]),
    hashed=lambda: hash(String()),
    in_a_list=lambda: String(data="a") in [String(), String(data="a")],
)
lines(
    "text",
    covariance=lambda: repr(PoseWithCovariance())[:120],
    joints=lambda: repr(JointState(name=["a"], position=[1.0])),
    bytes_=lambda: repr(UInt8MultiArray(data=b"ab")),
    status=lambda: repr(DiagnosticStatus(level=DiagnosticStatus.WARN, values=[KeyValue(key="k")])),
    quotes=lambda: repr(String(data='it\'s "x"\n')),
    request=lambda: repr(SetBool.Request(data=True)),
    response=lambda: repr(Trigger.Response(message="a")),
    goal=lambda: repr(Fibonacci.Goal(order=3)),
    feedback=lambda: repr(Fibonacci.Feedback(sequence=[1, 2])),
    float32=lambda: repr(Float32(data=0.1)),
    image=lambda: repr(Image(data=bytes(3)))[-60:],
    formatted=lambda: f"{Point(x=1.0)}",
    time_=lambda: str(TimeMessage(sec=1, nanosec=2)),
    slots=lambda: Point.__slots__,
    slots_of_an_object=lambda: [hasattr(String(), name) for name in ("__dict__", "_data")],
    unknown_attribute=lambda: setattr(String(), "dta", "x"),
    deleted=lambda: delattr(String(), "data"),
    positional=lambda: String("x"),
    class_attribute=lambda: String.data,
    fields=lambda: String.get_fields_and_field_types(),
    check=lambda: String(check_fields=True),
)


def _back(message: Any) -> Any:
    return deserialize_message(serialize_message(message), type(message))


def _text_in(data: Any) -> str:
    return deserialize_message(data, String).data


_TEXT = serialize_message(String(data="a"))
lines(
    "bytes",
    empty=lambda: serialize_message(Trigger.Request())[:5],
    string=lambda: serialize_message(String(data="é")),
    header=lambda: len(serialize_message(Header())),
    large=lambda: len(serialize_message(Image(data=bytes(3_000_000)))),
    large_back=lambda: len(_back(Image(data=bytes(3_000_000))).data),
    cloud=lambda: _back(PointCloud2()) == PointCloud2(),
    many=lambda: len(serialize_message(Polygon(points=[]))),
    infinities=lambda: list(
        deserialize_message(serialize_message(LaserScan(ranges=[np.inf, np.nan])), LaserScan).ranges
    ),
    type_after=lambda: type(_back(JointState(position=[1.0])).position).__name__,
    names_after=lambda: _back(JointState(name=["a", ""])).name,
    covariance_after=lambda: str(_back(PoseWithCovariance()).covariance.dtype),
    of_bytearray=lambda: _text_in(bytearray(_TEXT)),
    of_memoryview=lambda: _text_in(memoryview(_TEXT)),
    big_endian=lambda: _text_in(b"\0\0\0\0\0\0\0\2a\0"),
    request=lambda: serialize_message(SetBool.Request(data=True))[:5],
)
_MAX = 2**63 - 1
lines(
    "duration",
    maximum=lambda: Duration(nanoseconds=_MAX).nanoseconds == _MAX,
    beyond=lambda: Duration(nanoseconds=2**63),
    minimum=lambda: Duration(nanoseconds=-(2**63)).nanoseconds,
    below=lambda: Duration(nanoseconds=-(2**63) - 1),
    sum_beyond=lambda: Duration(nanoseconds=_MAX) + Duration(nanoseconds=1),
    difference=lambda: Duration(seconds=1) - Duration(seconds=2),
    infinite=lambda: Infinite,
    infinite_is=lambda: Infinite == Duration(nanoseconds=_MAX),
    infinite_plus=lambda: Infinite + Duration(seconds=1),
    float_seconds=lambda: Duration(seconds=0.1).nanoseconds,
    tiny=lambda: Duration(seconds=1e-10).nanoseconds,
    rounded=lambda: Duration(seconds=1.9999999999).nanoseconds,
    numpy_seconds=lambda: Duration(seconds=np.float64(1.5)).nanoseconds,
    numpy_nanoseconds=lambda: Duration(nanoseconds=np.int64(5)).nanoseconds,
    bool_=lambda: Duration(seconds=True).nanoseconds,
    nan=lambda: Duration(seconds=float("nan")),
    inf=lambda: Duration(seconds=float("inf")),
    twice=lambda: Duration(seconds=1) * 2,
    twice_other=lambda: 2 * Duration(seconds=1),
    halved=lambda: Duration(seconds=1) / 2,
    absolute=lambda: abs(Duration(seconds=-1)),
    sorted_=lambda: [d.nanoseconds for d in sorted([Duration(seconds=2), Duration(seconds=1)])],
    compared_to_number=lambda: Duration(seconds=1) > 1,
    compared_to_time=lambda: Duration(seconds=1) < Time(seconds=2),
    equal_message=lambda: Duration(seconds=1) == DurationMessage(sec=1),
    message_of_big=lambda: Duration(nanoseconds=_MAX).to_msg(),
    message_of_fraction=lambda: Duration(seconds=-0.5).to_msg(),
    from_wrong=lambda: Duration.from_msg(TimeMessage(sec=1)).nanoseconds,
    in_a_set=lambda: len({Duration(seconds=1), Duration(seconds=1)}),
    copied=lambda: copy.deepcopy(Duration(seconds=1)).nanoseconds,
    pickled=lambda: pickle.loads(pickle.dumps(Duration(seconds=1))).nanoseconds,
)
lines(
    "time",
    beyond=lambda: Time(nanoseconds=2**63),
    sum_beyond=lambda: Time(nanoseconds=_MAX) + Duration(nanoseconds=1),
    difference_beyond=lambda: Time(nanoseconds=0) - Duration(nanoseconds=1),
    float_seconds=lambda: Time(seconds=1.25).seconds_nanoseconds(),
    float_nanoseconds=lambda: Time(nanoseconds=1.5),
    numpy_seconds=lambda: Time(seconds=np.float32(1.5)).nanoseconds,
    text=lambda: str(Time(seconds=1, clock_type=ClockType.ROS_TIME)),
    text_of_type=lambda: repr(Time().clock_type),
    plus_number=lambda: Time(seconds=1) + 1,
    plus_message=lambda: Time(seconds=1) + DurationMessage(sec=1),
    number_plus=lambda: 1 + Time(seconds=1),
    minus_other_clock=lambda: Time(clock_type=ClockType.ROS_TIME) - Time(clock_type=1),
    equal_other=lambda: Time() == Time(clock_type=ClockType.ROS_TIME),
    at_least_other=lambda: Time() >= Time(clock_type=ClockType.ROS_TIME),
    compared_to_message=lambda: Time(seconds=1) < TimeMessage(sec=2),
    from_wrong=lambda: Time.from_msg(DurationMessage(sec=1)).nanoseconds,
    from_stamp=lambda: Time.from_msg(Header().stamp).clock_type,
    message_beyond=lambda: Time(seconds=2**32).to_msg(),
    in_a_set=lambda: len({Time(seconds=1), Time(seconds=1)}),
    copied=lambda: copy.copy(Time(seconds=1)).nanoseconds,
    pickled=lambda: pickle.loads(pickle.dumps(Time(seconds=1))).nanoseconds,
    zero_is_false=lambda: bool(Time()),
    negative=lambda: Time(seconds=-1),
    clock_as_number=lambda: Time(clock_type=1).clock_type,
    of_a_clock=lambda: type(Clock(clock_type=ClockType.STEADY_TIME).now()).__name__,
)
lines(
    "qos",
    presets=lambda: QoSPresetProfiles.short_keys(),
    preset=lambda: QoSPresetProfiles.get_from_short_key("sensor_data") == qos_profile_sensor_data,
    unknown_preset=lambda: QoSPresetProfiles.get_from_short_key("nope"),
    policy=lambda: ReliabilityPolicy.get_from_short_key("best_effort"),
    policy_upper=lambda: ReliabilityPolicy.get_from_short_key("BEST_EFFORT"),
    unknown_policy=lambda: DurabilityPolicy.get_from_short_key("nope"),
    short_keys=lambda: [kind.short_keys() for kind in (HistoryPolicy, LivelinessPolicy)],
    short_key=lambda: HistoryPolicy.KEEP_LAST.short_key,
    text=lambda: str(QoSProfile(depth=3)),
    infinite=lambda: QoSProfile(depth=1, deadline=Infinite).deadline.nanoseconds,
    infinite_equal=lambda: QoSProfile(depth=1, deadline=Infinite) == QoSProfile(depth=1),
    zero=lambda: QoSProfile(depth=1, deadline=Duration()) == QoSProfile(depth=1),
    numbers=lambda: QoSProfile(depth=1, reliability=2).reliability,
    wrong_number=lambda: QoSProfile(depth=1, reliability=9),
    conventions=lambda: (
        QoSProfile(depth=1, avoid_ros_namespace_conventions=True).avoid_ros_namespace_conventions
    ),
    unknown_argument=lambda: QoSProfile(depth=1, depht=2),
    positional=lambda: QoSProfile(1),
    negative=lambda: QoSProfile(depth=-1),
    bool_depth=lambda: QoSProfile(depth=True).depth,
    numpy_depth=lambda: QoSProfile(depth=np.int64(3)).depth,
    compatible=lambda: qos_check_compatible(QoSProfile(depth=1), QoSProfile(depth=1)),
    deadline=lambda: qos_check_compatible(
        QoSProfile(depth=1), QoSProfile(depth=1, deadline=Duration(seconds=1))
    )[0],
    reason=lambda: qos_check_compatible(qos_profile_sensor_data, QoSProfile(depth=1))[1],
    verdict=lambda: QoSCompatibility(2),
    new_attribute=lambda: setattr(QoSProfile(depth=1), "deph", 2),
)
lines(
    "name",
    topic=lambda: validate_topic_name("a/b"),
    topic_empty=lambda: validate_topic_name(""),
    topic_private=lambda: validate_topic_name("~a"),
    topic_braces=lambda: validate_topic_name("{a/b"),
    topic_unknown=lambda: validate_topic_name("{1a}/b"),
    topic_service=lambda: validate_topic_name("a b", is_service=True),
    full=lambda: validate_full_topic_name("/a"),
    full_relative=lambda: validate_full_topic_name("a"),
    full_long=lambda: validate_full_topic_name("/" + "a" * 300),
    full_service=lambda: validate_full_topic_name("/a//b", is_service=True),
    node=lambda: validate_node_name("a_1"),
    node_dot=lambda: validate_node_name("a.b"),
    node_long=lambda: validate_node_name("a" * 256),
    node_empty=lambda: validate_node_name(""),
    node_unicode=lambda: validate_node_name("é"),
    namespace=lambda: validate_namespace("/a/b"),
    namespace_end=lambda: validate_namespace("/a/"),
    namespace_long=lambda: validate_namespace("/" + "a" * 250),
    parameter=lambda: validate_parameter_name("a.b"),
    parameter_empty=lambda: validate_parameter_name(""),
    parameter_number=lambda: validate_topic_name(5),
)
lines(
    "parameter",
    of_numpy=lambda: Parameter("a", value=np.float64(1.0)).type_.name,
    of_numpy_array=lambda: Parameter("a", value=np.array([1.0])),
    of_array=lambda: Parameter("a", value=array.array("d", [1.0])).type_.name,
    of_tuple=lambda: Parameter("a", value=(1, 2)).type_.name,
    of_bytes=lambda: Parameter("a", value=[b"a"]).type_.name,
    of_plain_bytes=lambda: Parameter("a", value=b"a"),
    of_dict=lambda: Parameter("a", value={}),
    of_mixed=lambda: Parameter("a", value=[1, "a"]),
    of_empty=lambda: Parameter("a", value=[]).type_.name,
    of_none=lambda: Parameter("a", value=None).type_.name,
    wrong_type=lambda: Parameter("a", Parameter.Type.STRING, 5),
    type_only=lambda: Parameter("a", Parameter.Type.INTEGER),
    bool_as_integer=lambda: Parameter("a", Parameter.Type.INTEGER, True),
    to_message=lambda: Parameter("a", value=[1, 2]).to_parameter_msg(),
    from_message=lambda: Parameter.from_parameter_msg(ParameterMessage(name="a")).type_.name,
    value_unknown=lambda: parameter_value_to_python(ParameterValue(type=99)),
    value=lambda: parameter_value_to_python(
        ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=1.5)
    ),
    equal=lambda: Parameter("a", value=1) == Parameter("a", value=1),
    text=lambda: repr(Parameter("a", value=1)).split(" at ")[0],
    assigned=lambda: setattr(Parameter("a", value=1), "value", 2),
    type_of=lambda: Parameter.Type.from_parameter_value([1.0]).name,
    type_of_set=lambda: Parameter.Type.from_parameter_value({1}),
    type_check=lambda: [
        Parameter.Type.DOUBLE.check(value)
        for value in (
            1,
            1.0,
            "1",
            np.float64(1),
        )
    ],
)


def _ranged(value: Any, *others: Any, **fields: Any) -> Any:
    node = _node()
    node.declare_parameter("a", value, ParameterDescriptor(**fields))
    return [
        (result.successful, result.reason)
        for result in (node.set_parameters([Parameter("a", value=other)])[0] for other in others)
    ]


lines(
    "range",
    steps=lambda: _ranged(
        1, 2, 3, 0, 10, 11, integer_range=[IntegerRange(from_value=1, to_value=10, step=2)]
    ),
    end=lambda: _ranged(1, 9, 10, integer_range=[IntegerRange(from_value=1, to_value=10, step=4)]),
    float_steps=lambda: _ranged(
        0.0,
        0.3,
        0.30001,
        1.0,
        0.7,
        floating_point_range=[FloatingPointRange(from_value=0.0, to_value=1.0, step=0.1)],
    ),
    no_step=lambda: _ranged(
        0.0,
        0.12345,
        -1e-9,
        floating_point_range=[FloatingPointRange(from_value=0.0, to_value=1.0)],
    ),
    reversed_=lambda: _ranged(1, 2, integer_range=[IntegerRange(from_value=5, to_value=1)]),
    list_=lambda: _ranged(
        [1.0], [5.0], floating_point_range=[FloatingPointRange(from_value=0.0, to_value=1.0)]
    ),
    infinite=lambda: _ranged(
        0.0,
        float("inf"),
        float("nan"),
        floating_point_range=[FloatingPointRange(from_value=0.0, to_value=1.0)],
    ),
    read_only=lambda: _ranged(1, 2, 1, read_only=True),
    dynamic=lambda: _ranged(1, "a", [1.0], None, dynamic_typing=True),
    static_none=lambda: _ranged(1, None),
)


def _guard(*arguments: Any, **options: Any) -> Any:
    guard = GuardCondition(*arguments, **options)
    return [
        guard.callback is print,
        guard.callback_group,
        *map(outcome, (guard.trigger, guard.destroy, guard.trigger)),
    ]


lines(
    "guard",
    without_group=lambda: _guard(print, None),
    context=lambda: _guard(print, None, rclpy.get_default_context()),
    keyword=lambda: _guard(print, None, context=rclpy.get_default_context()),
    no_context=lambda: _guard(print, None, context=None),
    nothing=lambda: GuardCondition(),
    callback_only=lambda: GuardCondition(print),
)


@probe
def guard_of_a_context_that_is_shut_down() -> Any:
    context = Context()
    context.init(args=[])
    guard = GuardCondition(print, None, context=context)
    context.shutdown()
    return [outcome(guard.trigger), outcome(GuardCondition, print, None, context=context)]


@probe
def destroyed_action_client() -> Any:
    client = ActionClient(_node(), Fibonacci, "count")
    client.destroy()
    return [
        outcome(client.server_is_ready),
        outcome(client.wait_for_server, 0.1),
        outcome(client.send_goal_async, Fibonacci.Goal()),
        outcome(client.send_goal_async, 3),
        outcome(client.destroy),
    ]


@probe
def status_of_a_goal_after_its_acceptance() -> Any:
    node, goals = _node(), []
    ActionServer(
        node,
        Fibonacci,
        "count",
        lambda goal: _succeed(goal),
        handle_accepted_callback=goals.append,
    )
    future = ActionClient(node, Fibonacci, "count").send_goal_async(Fibonacci.Goal())
    rclpy.spin_until_future_complete(node, future, timeout_sec=10.0)
    seen = [future.result().status, goals[0].status]
    goals[0].execute()
    end = time.monotonic() + 1.0
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.02)
    return [*seen, future.result().status, goals[0].status]


def _succeed(goal: Any) -> Any:
    goal.succeed()
    return Fibonacci.Result()


lines(
    "signal",
    interrupt=lambda: signal.getsignal(signal.SIGINT),
    termination=lambda: signal.getsignal(signal.SIGTERM),
    replaced=lambda: signal.signal(signal.SIGTERM, signal.SIG_DFL),
)


def _logged(*calls: Any) -> Any:
    logger = get_logger("probe.child")
    logger.set_level(LoggingSeverity.FATAL)
    return [outcome(call, logger) for call in calls]


lines(
    "logger",
    levels=lambda: [level.name for level in LoggingSeverity],
    child=lambda: get_logger("a").get_child("b").name,
    child_empty=lambda: get_logger("a").get_child(""),
    child_of_root=lambda: get_logger("").get_child("b").name,
    child_number=lambda: get_logger("a").get_child(5),
    level_of_child=lambda: (
        get_logger("p").set_level(40),
        get_logger("p").get_child("q").get_effective_level(),
    )[1],
    own_level=lambda: (
        get_logger("z.unset").get_level() if hasattr(get_logger("z.unset"), "get_level") else "none"
    ),
    enabled=lambda: get_logger("p.x").is_enabled_for(LoggingSeverity.ERROR),
    wrong_level=lambda: get_logger("p").set_level("nope"),
    text_level=lambda: get_logger("p").set_level("DEBUG"),
    log_level=lambda: _logged(
        lambda logger: logger.log("a", 99),
        lambda logger: logger.log("a", "INFO"),
        lambda logger: logger.log("a", LoggingSeverity.INFO),
    ),
    throttle=lambda: _logged(
        lambda logger: logger.info("a", throttle_duration_sec="x"),
        lambda logger: logger.info("a", throttle_duration_sec=1.0, throttle_time_source_type="x"),
    ),
    filters=lambda: _logged(
        lambda logger: logger.info("a", once=True, skip_first=True),
        lambda logger: logger.info("a", nope=True),
    ),
    time_source=lambda: _logged(
        lambda logger: logger.info("a", throttle_time_source_type="STEADY_TIME"),
    ),
    warn_=lambda: _logged(
        lambda logger: logger.warn("a"),
        lambda logger: logger.fatal("a"),
        lambda logger: logger.error(),
    ),
)

if __name__ == "__main__":
    main()
