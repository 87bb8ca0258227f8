from collections import OrderedDict

import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PointStamped, Polygon, Twist
from rosidl_runtime_py import (
    message_to_csv,
    message_to_ordereddict,
    message_to_yaml,
    set_message_fields,
)
from rosidl_runtime_py.utilities import get_action, get_interface, get_message, get_service, is_message
from std_srvs.srv import Trigger


def test_types_are_found_by_name_with_and_without_their_subfolder() -> None:
    assert get_message("geometry_msgs/msg/Twist") is get_message("geometry_msgs/Twist") is Twist
    assert get_service("std_srvs/srv/Trigger") is get_interface("std_srvs/srv/Trigger") is Trigger
    assert get_action("example_interfaces/Fibonacci").Goal(order=3).order == 3
    feedback = get_interface("example_interfaces/action/Fibonacci_FeedbackMessage")
    assert is_message(feedback())


@pytest.mark.parametrize(
    ("name", "error"),
    [
        ("std_srvs/srv/Trigger", ValueError),
        ("no_msgs/msg/No", ModuleNotFoundError),
        ("std_msgs/msg/No", AttributeError),
    ],
)
def test_invalid_type_name_raises_the_error_of_ros(name: str, error: type[Exception]) -> None:
    with pytest.raises(error):
        get_message(name)


def test_fields_are_set_from_dicts_with_nested_messages_and_lists() -> None:
    twist, polygon = Twist(), Polygon()
    assert set_message_fields(twist, {"linear": {"x": 1}, "angular": {"z": -0.5}}) == []
    assert (twist.linear.x, twist.angular.z) == (1.0, -0.5)
    set_message_fields(polygon, {"points": [{"x": 1.0}, {"y": 2.0}]})
    assert [(point.x, point.y) for point in polygon.points] == [(1.0, 0.0), (0.0, 2.0)]
    set_message_fields(polygon, {"points": polygon.points[:1]})
    assert len(polygon.points) == 1


def test_time_fields_are_returned_for_later_only_on_request() -> None:
    stamped = PointStamped()
    (setter,) = set_message_fields(stamped, {"header": "auto"}, expand_header_auto=True)
    setter(Time(sec=7))
    assert stamped.header.stamp.sec == 7
    (setter,) = set_message_fields(stamped, {"header": {"stamp": "now"}}, expand_time_now=True)
    setter(Time(sec=8))
    assert stamped.header.stamp.sec == 8
    with pytest.raises(TypeError, match="Value 'auto' is expected to be a dictionary but is a str"):
        set_message_fields(stamped, {"header": "auto"})


@pytest.mark.parametrize(("values", "error"), [({"lin": {}}, AttributeError), ({"linear": 3}, TypeError)])
def test_invalid_field_values_raise_the_error_of_ros(
    values: dict[str, object], error: type[Exception]
) -> None:
    with pytest.raises(error):
        set_message_fields(Twist(), values)


def test_message_is_converted_to_a_dict_yaml_and_csv() -> None:
    stamped = PointStamped()
    stamped.header.frame_id = "a long frame"
    stamped.point.x = 1.5
    ordered = message_to_ordereddict(stamped, truncate_length=6)
    assert isinstance(ordered["header"], OrderedDict)
    assert list(ordered) == ["header", "point"]
    assert (ordered["header"]["frame_id"], ordered["point"]["x"]) == ("a long...", 1.5)
    assert message_to_yaml(stamped, flow_style=True).startswith("{header: {stamp: {sec: 0, nanosec: 0}")
    assert message_to_csv(stamped) == "0,0,a long frame,1.5,0.0,0.0"
    assert message_to_csv(stamped, no_str=True) == "0,0,<string length: <12>>,1.5,0.0,0.0"
