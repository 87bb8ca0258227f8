from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseWithCovariance, Twist
from hypothesis import given
from hypothesis import strategies as st
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import Bool, Float64MultiArray, Header, Int8, String
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker

from course_lib.errors import CourseError
from course_lib.ros.messages import RosMessage
from course_lib.ros.messages.conversions import PrintOptions, to_yaml
from course_lib.tools.verb import fill


def filled(kind: type[RosMessage], text: str) -> Any:
    message = kind()
    assert fill(message, text) == []
    return message


def test_values_are_converted_to_field_types() -> None:
    assert filled(Twist, "{linear: {x: 1}}").linear.x == 1.0
    assert filled(Twist, "linear:\n  x: 2.5").linear.x == 2.5
    assert filled(String, "data: 5").data == "5"
    assert filled(Bool, "data: true").data is True
    assert list(filled(LaserScan, "ranges: [1, 2]").ranges) == [1.0, 2.0]
    assert filled(PoseWithCovariance, f"covariance: {[1] * 36}").covariance.sum() == 36
    assert filled(JointState, "name: [a, b]").name == ["a", "b"]
    assert filled(DiagnosticStatus, "level: 2").level == DiagnosticStatus.ERROR


def test_nested_messages_keep_their_defaults() -> None:
    marker = filled(Marker, "{points: [{x: 1}, {y: 2}], pose: {position: {z: 3}}}")
    assert [(point.x, point.y) for point in marker.points] == [(1, 0), (0, 2)]
    assert marker.pose.orientation.w == 1.0
    array = filled(DiagnosticArray, "status: [{name: a, values: [{key: k, value: v}]}]")
    assert array.status[0].values[0].value == "v"


def test_now_and_auto_are_replaced_at_publishing_time() -> None:
    tf = TFMessage()
    times = fill(tf, "transforms: [{header: {stamp: now}}, {header: auto}]")
    stamp = Header().stamp
    stamp.sec = 7
    for set_time in times:
        set_time(stamp)
    assert [one.header.stamp.sec for one in tf.transforms] == [7, 7]


@pytest.mark.slow
@given(st.lists(st.floats(allow_nan=False)), st.text(), st.floats(allow_nan=False))
def test_echo_output_is_accepted_by_pub(data: list[float], label: str, x: float) -> None:
    for message in (Float64MultiArray(data=data), JointState(name=[label]), Marker(text=label)):
        if "\x85" not in label and label.isprintable():  # YAML keeps these only as escapes
            assert filled(type(message), to_yaml(message, PrintOptions(truncate=None))) == message


@pytest.mark.parametrize(
    ("kind", "text", "says"),
    [
        (String, "data:hi", "The passed value needs to be a dictionary in YAML format"),
        (String, "[1]", "The passed value needs to be a dictionary in YAML format"),
        (String, "{data: [}", "is not YAML"),
        (
            String,
            "{dat: hi}",
            "Failed to populate field: 'String' object has no attribute 'dat'. std_msgs",
        ),
        (Twist, "{linear: 1}", "Value '1' is expected to be a dictionary but is a int"),
        (Twist, "{linear: {x: fast}}", "Failed to populate field: could not convert string to float: 'fast'"),
        (Int8, "{data: 200}", "Failed to populate field: The 'data' field must be an integer in [-128, 127]"),
        (Marker, "{points: 3}", "Failed to populate field: 'int' object is not iterable"),
    ],
)
def test_invalid_values_have_the_error_text_of_ros(kind: type[RosMessage], text: str, says: str) -> None:
    with pytest.raises(CourseError) as raised:
        fill(kind(), text)
    assert says in str(raised.value)
