# mypy: ignore-errors
"""Objects that programs create and compare: profiles, clocks, times, descriptors, messages; their str().

Many of the calls are wrong on purpose.
"""

import array
import copy
import pickle
import time
from typing import Any

import numpy as np
import rclpy
from builtin_interfaces.msg import Duration as DurationMsg
from builtin_interfaces.msg import Time as TimeMsg
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion, Twist, Vector3
from probing import lines, main, outcome, probe
from rcl_interfaces.msg import (
    FloatingPointRange,
    IntegerRange,
    ParameterDescriptor,
    ParameterType,
    SetParametersResult,
)
from rclpy.clock import Clock, ClockType, JumpThreshold, ROSClock
from rclpy.duration import Duration, Infinite
from rclpy.node import Node
from rclpy.parameter import Parameter, parameter_dict_from_yaml_file
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPolicyKind,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_action_status_default,
    qos_profile_best_available,
    qos_profile_default,
    qos_profile_parameter_events,
    qos_profile_parameters,
    qos_profile_sensor_data,
    qos_profile_services_default,
    qos_profile_system_default,
    qos_profile_unknown,
)
from rclpy.qos_overriding_options import QosCallbackResult, QoSOverridingOptions
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.time import Time
from sensor_msgs.msg import Image, JointState, LaserScan, PointCloud2, PointField
from std_msgs.msg import (
    Bool,
    Byte,
    Char,
    ColorRGBA,
    Empty,
    Float32,
    Float64,
    Header,
    Int8,
    Int32,
    Int64,
    MultiArrayLayout,
    String,
    UInt8MultiArray,
    UInt64,
)
from std_srvs.srv import SetBool
from visualization_msgs.msg import Marker, MarkerArray


def _profile(profile: Any) -> Any:
    names = ["history", "depth", "reliability", "durability", "lifespan", "deadline", "liveliness"]
    names += ["liveliness_lease_duration", "avoid_ros_namespace_conventions"]
    return [str(getattr(profile, name)) for name in names]


def _overridden(options: Any, given: Any = (), profile: Any = 7) -> Any:
    node = Node("n", cli_args=["--ros-args", *(word for one in given for word in ("-p", one))])
    publisher = node.create_publisher(String, "t", profile, qos_overriding_options=options)
    named = sorted(name for name in node._parameters if name.startswith("qos_overrides"))
    return [_profile(publisher.qos_profile), named]


_P = "qos_overrides./t.publisher."
lines(
    "qos",
    default=lambda: _profile(qos_profile_default),
    unknown=lambda: _profile(qos_profile_unknown),
    sensor_data=lambda: _profile(qos_profile_sensor_data),
    services=lambda: _profile(qos_profile_services_default),
    parameters=lambda: _profile(qos_profile_parameters),
    parameter_events=lambda: _profile(qos_profile_parameter_events),
    system=lambda: _profile(qos_profile_system_default),
    action_status=lambda: _profile(qos_profile_action_status_default),
    best_available=lambda: _profile(qos_profile_best_available),
    depth_one=lambda: _profile(QoSProfile(depth=1)),
    keep_all=lambda: _profile(QoSProfile(history=HistoryPolicy.KEEP_ALL)),
    keep_last_without_depth=lambda: QoSProfile(history=HistoryPolicy.KEEP_LAST),
    nothing=lambda: QoSProfile(),
    depth_zero=lambda: _profile(QoSProfile(depth=0)),
    depth_of_a_bool=lambda: _profile(QoSProfile(depth=True)),
    depth_none=lambda: QoSProfile(depth=None),
    int_as_history=lambda: _profile(QoSProfile(depth=1, history=1)),
    text_as_history=lambda: QoSProfile(depth=1, history="keep_last"),
    infinite_lifespan=lambda: _profile(QoSProfile(depth=1, lifespan=Infinite)),
    preset_value=lambda: _profile(QoSPresetProfiles.SENSOR_DATA.value),
    preset_key=lambda: _profile(QoSPresetProfiles.get_from_short_key("SENSOR_DATA")),
    preset_wrong_key=lambda: QoSPresetProfiles.get_from_short_key("sensors"),
    preset_text=lambda: str(QoSPresetProfiles.SENSOR_DATA).partition(":")[0],
    preset_equal=lambda: QoSPresetProfiles.SENSOR_DATA.value == qos_profile_sensor_data,
    preset_as_profile=lambda: Node("n").create_publisher(String, "t", QoSPresetProfiles.SENSOR_DATA),
    text_as_profile=lambda: Node("n").create_publisher(String, "t", "10"),
    float_as_profile=lambda: Node("n").create_publisher(String, "t", 1.0),
    negative_as_profile=lambda: Node("n").create_publisher(String, "t", -1),
    bool_as_profile=lambda: Node("n").create_publisher(String, "t", True).qos_profile.depth,
    zero_as_profile=lambda: Node("n").create_publisher(String, "t", 0).qos_profile.depth,
    numpy_as_profile=lambda: Node("n").create_publisher(String, "t", np.int64(3)),
    policy_as_profile=lambda: Node("n").create_publisher(String, "t", ReliabilityPolicy.RELIABLE),
    none_as_profile=lambda: Node("n").create_subscription(String, "t", print, None),
    equal_to_copy=lambda: copy.copy(qos_profile_sensor_data) == qos_profile_sensor_data,
    equal_with_other_depth=lambda: QoSProfile(depth=1) == QoSProfile(depth=2),
    equal_to_none=lambda: QoSProfile(depth=1) == None,  # noqa: E711
    unequal=lambda: QoSProfile(depth=1) != QoSProfile(depth=1),
    policies=lambda: [str(ReliabilityPolicy.RELIABLE), repr(DurabilityPolicy.VOLATILE), LivelinessPolicy(1)],
    policy_from_text=lambda: ReliabilityPolicy["RELIABLE"],
    policy_from_number=lambda: HistoryPolicy(9),
    policy_of_another_kind=lambda: ReliabilityPolicy.RELIABLE == DurabilityPolicy.TRANSIENT_LOCAL,
    policy_short_key=lambda: [ReliabilityPolicy.BEST_EFFORT.short_key, HistoryPolicy.KEEP_ALL.short_key],
    policy_from_short_key=lambda: LivelinessPolicy.get_from_short_key("automatic"),
    policy_from_wrong_key=lambda: DurabilityPolicy.get_from_short_key("latched"),
    policy_kind=lambda: [str(QoSPolicyKind.DEPTH), int(QoSPolicyKind.DEPTH)],
    overriding_default=lambda: _overridden(QoSOverridingOptions.with_default_policies()),
    overriding_depth=lambda: _overridden(
        QoSOverridingOptions.with_default_policies(), [f"{_P}depth:=3", f"{_P}reliability:=best_effort"]
    ),
    overriding_wrong_key=lambda: _overridden(
        QoSOverridingOptions.with_default_policies(), [f"{_P}reliability:=maybe"]
    ),
    overriding_wrong_type=lambda: _overridden(
        QoSOverridingOptions.with_default_policies(), [f"{_P}depth:=many"]
    ),
    overriding_not_asked=lambda: _overridden(None, [f"{_P}depth:=3"]),
    overriding_id=lambda: _overridden(QoSOverridingOptions([QoSPolicyKind.DEPTH], entity_id="mine")),
    overriding_refused=lambda: _overridden(
        QoSOverridingOptions.with_default_policies(callback=lambda profile: QosCallbackResult())
    ),
    overriding_accepted=lambda: _overridden(
        QoSOverridingOptions.with_default_policies(callback=lambda profile: _accepted())
    ),
    overriding_callback_none=lambda: _overridden(
        QoSOverridingOptions.with_default_policies(callback=lambda profile: None)
    ),
    overriding_invalid=lambda: _overridden(QoSOverridingOptions([QoSPolicyKind.INVALID])),
    overriding_deadline=lambda: _overridden(
        QoSOverridingOptions([QoSPolicyKind.DEADLINE]), [f"{_P}deadline:=1000"]
    ),
)


def _accepted() -> Any:
    result = QosCallbackResult()
    result.successful = True
    return result


lines(
    "duration",
    zero=lambda: [Duration() == Duration(seconds=0), bool(Duration())],
    of_numpy=lambda: Duration(seconds=np.float64(1.5)).nanoseconds,
    of_a_bool=lambda: Duration(seconds=True).nanoseconds,
    of_nan=lambda: Duration(seconds=float("nan")),
    of_infinity=lambda: Duration(seconds=float("inf")),
    infinite=lambda: [str(Infinite), Infinite == Duration(seconds=9223372036, nanoseconds=854775807)],
    minutes=lambda: Duration(minutes=1),
    copied=lambda: copy.copy(Duration(seconds=1)) == Duration(seconds=1),
    deeply_copied=lambda: copy.deepcopy(Duration(seconds=1)),
    pickled=lambda: pickle.dumps(Duration(seconds=1)),
    rounded=lambda: [Duration(seconds=0.1).nanoseconds, Duration(seconds=1e-10).nanoseconds],
    sorted=lambda: [d.nanoseconds for d in sorted([Duration(seconds=2), Duration(seconds=1)])],
    equal_to_message=lambda: Duration(seconds=1) == DurationMsg(sec=1),
    less_than_message=lambda: Duration(seconds=1) < DurationMsg(sec=1),
    summed=lambda: sum([Duration(seconds=1)], Duration()),
    absolute=lambda: abs(Duration(seconds=-1)),
    as_float=lambda: float(Duration(seconds=1)),
    format=lambda: f"{Duration(seconds=1)}",
    of_negative_message=lambda: Duration.from_msg(DurationMsg(sec=-1, nanosec=500000000)).nanoseconds,
)
lines(
    "time",
    zero=lambda: [Time() == Time(), bool(Time()), Time().nanoseconds],
    of_other_clock_zero=lambda: Time() == Time(clock_type=ClockType.ROS_TIME),
    of_numpy=lambda: Time(seconds=np.float64(1.5)).nanoseconds,
    of_a_text=lambda: Time(seconds="1"),
    of_none=lambda: Time(seconds=None),
    of_nan=lambda: Time(seconds=float("nan")),
    positional=lambda: Time(1),
    minus_int=lambda: Time(seconds=1) - 1,
    minus_message=lambda: Time(seconds=1) - TimeMsg(sec=1),
    plus_message=lambda: Time(seconds=1) + DurationMsg(sec=1),
    plus_negative=lambda: (Time(seconds=2) + Duration(seconds=-1)).nanoseconds,
    plus_negative_too_far=lambda: Time(seconds=1) + Duration(seconds=-2),
    minus_negative_duration=lambda: (Time(seconds=1) - Duration(seconds=-1)).nanoseconds,
    duration_minus_time=lambda: Duration(seconds=1) - Time(seconds=1),
    increased=lambda: _increased(),
    difference_negative=lambda: (Time(seconds=1) - Time(seconds=2)).nanoseconds,
    in_a_dict=lambda: {Time(): 1},
    deeply_copied=lambda: copy.deepcopy(Time(seconds=1)),
    pickled=lambda: pickle.dumps(Time(seconds=1)),
    largest=lambda: Time.max() if hasattr(Time, "max") else None,
    seconds_nanoseconds=lambda: Time(seconds=1.75).seconds_nanoseconds(),
    round_trip=lambda: Time.from_msg(Time(seconds=3, nanoseconds=4).to_msg()).nanoseconds,
    message_of_far_future=lambda: Time(seconds=2**31).to_msg(),
    from_message_positional=lambda: Time.from_msg(TimeMsg(sec=1), ClockType.SYSTEM_TIME).clock_type.name,
    from_none=lambda: Time.from_msg(None),
    clock_type_int=lambda: Time(clock_type=1),
    as_stamp=lambda: Header(stamp=Time(seconds=1)),
    as_stamp_message=lambda: Header(stamp=Time(seconds=1).to_msg()).stamp.sec,
    sorted=lambda: [t.nanoseconds for t in sorted([Time(seconds=2), Time(seconds=1)])],
)


def _increased() -> Any:
    stamp = Time(seconds=1)
    stamp += Duration(seconds=1)
    return stamp


lines(
    "clock",
    of_int=lambda: Clock(clock_type=3),
    uninitialized=lambda: Clock(clock_type=ClockType.UNINITIALIZED),
    is_ros_clock=lambda: isinstance(Clock(clock_type=ClockType.ROS_TIME), ROSClock),
    of_a_node=lambda: [type(Node("n").get_clock()).__name__, Node("n").get_clock().clock_type.name],
    node_now=lambda: Node("n").get_clock().now().clock_type.name,
    override_of_system=lambda: Clock().set_ros_time_override(Time()),
    override_of_another_type=lambda: ROSClock().set_ros_time_override(Time(seconds=1)),
    sleep_for_int=lambda: Clock().sleep_for(1),
    sleep_until_now=lambda: (lambda clock: clock.sleep_until(clock.now()))(Clock()),
    sleep_for_short=lambda: Clock().sleep_for(Duration(seconds=0.01)),
    sleep_after_shutdown=lambda: (rclpy.shutdown(), Clock().sleep_for(Duration(seconds=0.01))),
    equal=lambda: Clock() == Clock(),
    threshold=lambda: (
        JumpThreshold(
            min_forward=Duration(seconds=1), min_backward=Duration(seconds=-1), on_clock_change=False
        ).on_clock_change
    ),
    threshold_without_change=lambda: JumpThreshold(min_forward=None, min_backward=None),
    timer_of_another_clock=lambda: Node("n").create_timer(1.0, print, clock=Clock()).clock.clock_type.name,
    rate_period=lambda: Node("n").create_rate(4)._timer.timer_period_ns,
)


def _described(value: Any, **fields: Any) -> Any:
    node = Node("n")
    found = node.declare_parameter("a", value, ParameterDescriptor(**fields))
    return [found.value, node.describe_parameter("a").type, node.describe_parameter("a").name]


def _set_described(value: Any, other: Any, **fields: Any) -> Any:
    node = Node("n")
    node.declare_parameter("a", value, ParameterDescriptor(**fields))
    return [node.set_parameters([Parameter("a", value=other)])[0], node.get_parameter("a").value]


_INTEGERS = {"integer_range": [IntegerRange(from_value=0, to_value=10, step=5)]}
_FLOATS = {"floating_point_range": [FloatingPointRange(from_value=0.0, to_value=1.0, step=0.25)]}
lines(
    "descriptor",
    name_is_replaced=lambda: _described(1, name="other"),
    type_is_replaced=lambda: _described(1, type=ParameterType.PARAMETER_STRING),
    read_only=lambda: _set_described(1, 2, read_only=True),
    dynamic=lambda: _set_described(1, "x", dynamic_typing=True),
    dynamic_none=lambda: _described(None, dynamic_typing=True),
    range_below=lambda: _set_described(5, -1, **_INTEGERS),
    range_edge=lambda: _set_described(5, 10, **_INTEGERS),
    range_between_steps=lambda: _set_described(5, 7, **_INTEGERS),
    range_initial=lambda: _described(11, **_INTEGERS),
    range_of_float=lambda: _set_described(0.5, 0.75, **_FLOATS),
    range_of_float_between=lambda: _set_described(0.5, 0.6, **_FLOATS),
    range_of_float_above=lambda: _set_described(0.5, 1.5, **_FLOATS),
    range_of_float_close=lambda: _set_described(0.5, 0.25 + 1e-12, **_FLOATS),
    range_of_float_nan=lambda: _set_described(0.5, float("nan"), **_FLOATS),
    range_of_another_type=lambda: _set_described(1, 100, **_FLOATS),
    range_for_a_list=lambda: _set_described([1, 2], [100, 200], **_INTEGERS),
    two_ranges=lambda: ParameterDescriptor(integer_range=[IntegerRange(), IntegerRange()]),
    range_reversed=lambda: _described(5, integer_range=[IntegerRange(from_value=10, to_value=0, step=1)]),
    range_without_step=lambda: _set_described(5, 6, integer_range=[IntegerRange(from_value=0, to_value=10)]),
    set_descriptor=lambda: _changed_descriptor(),
    description=lambda: _described(1, description="text", additional_constraints="more"),
    text=lambda: str(ParameterDescriptor(name="a"))[:80],
    result_text=lambda: str(SetParametersResult(successful=True, reason="r")),
    same_value_twice=lambda: _set_described(1, 1),
    numpy_value=lambda: _described(np.float64(1.0)),
    numpy_int=lambda: _described(np.int64(1)),
    numpy_list=lambda: _described(np.array([1.0, 2.0])),
    tuple_value=lambda: _described((1, 2)),
    bytes_list=lambda: _described([b"a", b"b"]),
    bool_for_int=lambda: _set_described(1, True),
    int_for_bool=lambda: _set_described(True, 1),
    float_for_int=lambda: _set_described(1, 2.0),
    none_for_int=lambda: _set_described(1, None),
    huge_int=lambda: _described(2**63),
    mixed_list=lambda: _described([1, 2.0]),
    yaml_dict=lambda: parameter_dict_from_yaml_file("/nowhere.yaml"),
    parameter_equal_types=lambda: Parameter("a", value=1) == Parameter("a", value=1.0),
    parameter_repr=lambda: type(repr(Parameter("a", value=1))).__name__,
    parameter_of_int_type=lambda: Parameter("a", 2, 3).type_,
    parameter_of_name_none=lambda: Parameter(None, value=1).name,
    parameter_of_list_of_tuples=lambda: Parameter("a", value=[(1, 2)]),
    parameter_of_empty_tuple=lambda: Parameter("a", value=()).type_.name,
    parameter_of_range=lambda: Parameter("a", value=range(3)),
    parameter_of_complex=lambda: Parameter("a", value=1j),
    types_from_value=lambda: [Parameter.Type.from_parameter_value(v).name for v in (1, 1.0, "", True, [1])],
)


def _changed_descriptor() -> Any:
    node = Node("n")
    node.declare_parameter("a", 5)
    return [
        outcome(node.set_descriptor, "a", ParameterDescriptor(**_INTEGERS)),
        node.set_parameters([Parameter("a", value=100)])[0].successful,
        outcome(node.set_descriptor, "a", ParameterDescriptor(**_INTEGERS), Parameter("a", value=7)),
    ]


def _assigned(kind: Any, field: Any, value: Any) -> Any:
    message = kind()
    setattr(message, field, value)
    return deserialize_message(serialize_message(message), kind)


lines(
    "message",
    positional=lambda: Point(1.0, 2.0, 3.0),
    unknown_field=lambda: Point(w=1.0),
    unknown_attribute=lambda: setattr(Point(), "w", 1.0),
    equal=lambda: [Point(x=1.0) == Point(x=1.0), Point() == Vector3(), Point() == None],  # noqa: E711
    hashed=lambda: {Point(): 1},
    copied=lambda: copy.deepcopy(Pose(position=Point(x=1.0))).position.x,
    shallow_copy_shares=lambda: _shared(),
    pickled=lambda: pickle.loads(pickle.dumps(Point(x=1.0))).x,
    ordered=lambda: Point() < Point(),
    of_numpy_float=lambda: _assigned(Float64, "data", np.float64(1.5)),
    of_numpy_float32=lambda: _assigned(Float32, "data", np.float64(1.5)),
    of_int64=lambda: _assigned(Int64, "data", -(2**63)),
    of_uint64=lambda: _assigned(UInt64, "data", 2**64 - 1),
    of_int8=lambda: _assigned(Int8, "data", -128),
    of_bool=lambda: _assigned(Bool, "data", True),
    of_byte=lambda: _assigned(Byte, "data", b"x"),
    of_char=lambda: _assigned(Char, "data", 120),
    of_array_array=lambda: _assigned(LaserScan, "ranges", array.array("f", [1.0, 2.0])).ranges.tolist(),
    of_inf=lambda: list(_assigned(LaserScan, "ranges", [float("inf"), 1.0]).ranges),
    of_bytes=lambda: bytes(_assigned(Image, "data", b"abc").data),
    of_bytearray=lambda: bytes(_assigned(Image, "data", bytearray(b"abc")).data),
    of_memoryview=lambda: bytes(_assigned(Image, "data", memoryview(b"abc")).data),
    of_numpy_bytes=lambda: bytes(_assigned(Image, "data", np.array([1, 2], dtype=np.uint8)).data),
    of_numpy_2d=lambda: bytes(_assigned(Image, "data", np.array([[1, 2], [3, 4]], dtype=np.uint8)).data),
    of_names=lambda: _assigned(JointState, "name", ("a", "b")).name,
    of_numpy_names=lambda: _assigned(JointState, "name", np.array(["a", "b"])).name,
    of_numpy_objects=lambda: _assigned(JointState, "name", np.array(["a", "b"], dtype=object)).name,
    of_numpy_words=lambda: _assigned(String, "data", np.array(["a", "b"])[0]),
    of_keys=lambda: _assigned(JointState, "name", {"a": 1}.keys()).name,
    of_numpy_markers=lambda: len(_assigned(MarkerArray, "markers", np.array([Marker()])).markers),
    of_a_generator=lambda: list(_assigned(JointState, "position", (x for x in (1.0, 2.0))).position),
    of_a_set=lambda: sorted(_assigned(JointState, "position", {1.0, 2.0}).position),
    of_a_dict=lambda: list(_assigned(JointState, "position", {1.0: 2}).position),
    of_nested=lambda: _assigned(Pose, "position", Point(x=2.0)).position.x,
    of_markers=lambda: len(_assigned(MarkerArray, "markers", [Marker(), Marker()]).markers),
    of_markers_tuple=lambda: len(_assigned(MarkerArray, "markers", (Marker(),)).markers),
    of_empty=lambda: _assigned(String, "data", ""),
    of_umlaut=lambda: _assigned(String, "data", "äöü"),
    of_newline=lambda: _assigned(String, "data", "a\nb"),
    appended=lambda: _appended(),
    shared_lists=lambda: [JointState().name is JointState().name, Pose().position is Pose().position],
    text_of_twist=lambda: str(Twist(linear=Vector3(x=1.0))),
    text_of_header=lambda: str(Header(frame_id="map")),
    text_of_color=lambda: str(ColorRGBA(r=0.1)),
    text_of_empty=lambda: str(Empty()),
    text_of_joints=lambda: str(JointState(name=["a"], position=[1.0])),
    text_of_bytes=lambda: str(UInt8MultiArray(data=b"ab")),
    text_of_request=lambda: str(SetBool.Request(data=True)),
    text_of_long_list=lambda: str(LaserScan(ranges=[0.5] * 3)),
    text_of_layout=lambda: str(MultiArrayLayout()),
    text_of_nan=lambda: str(Point(x=float("nan"), y=float("inf"))),
    text_of_quaternion=lambda: str(Quaternion()),
    slots=lambda: PoseStamped.__slots__,
    fields=lambda: PointField.get_fields_and_field_types(),
    constants=lambda: [PointField.FLOAT32, Marker.ARROW, Marker().TEXT_VIEW_FACING],
    constant_dir=lambda: "FLOAT32" in dir(PointField),
    request_of_response=lambda: SetBool.Response.get_fields_and_field_types(),
    service_called=lambda: SetBool(),
    module=lambda: [Point.__module__.split(".")[0], Point.__name__, SetBool.Request.__name__],
    serialized_point=lambda: serialize_message(Point(x=1.0)),
    serialized_cloud=lambda: len(serialize_message(PointCloud2(data=b"1234"))),
    deserialized_bytearray=lambda: deserialize_message(bytearray(serialize_message(Int32(data=5))), Int32),
    deserialized_memoryview=lambda: deserialize_message(memoryview(serialize_message(Int32(data=5))), Int32),
    deserialized_big_endian=lambda: deserialize_message(b"\0\0\0\0\0\0\0\5", Int32),
    deserialized_as_another_type=lambda: deserialize_message(serialize_message(Int32(data=1)), Bool),
)


def _shared() -> Any:
    pose = Pose()
    other = copy.copy(pose)
    other.position.x = 3.0
    return pose.position.x


def _appended() -> Any:
    message = JointState()
    message.position.append(1)
    message.name.append("a")
    return [message.position.tolist(), message.name, outcome(message.position.append, "x")]


@probe
def time_of_a_stamp_survives_publishing() -> Any:
    node, seen = Node("n"), []
    publisher = node.create_publisher(PoseStamped, "t", 1)
    node.create_subscription(PoseStamped, "t", lambda m: seen.append(Time.from_msg(m.header.stamp)), 1)
    message = PoseStamped()
    message.header.stamp = Time(seconds=12, nanoseconds=34).to_msg()
    end = time.monotonic() + 5.0
    while not seen and time.monotonic() < end:
        publisher.publish(message)
        rclpy.spin_once(node, timeout_sec=0.05)
    return seen[:1]


if __name__ == "__main__":
    main()
