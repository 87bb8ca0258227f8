from collections import OrderedDict
from pathlib import Path

import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import PointStamped, Polygon, Twist
from rosidl_runtime_py import (
    get_action_interfaces,
    get_interface_packages,
    get_interface_path,
    get_interfaces,
    get_message_interfaces,
    get_message_slot_types,
    get_service_interfaces,
    import_message_from_namespaced_type,
    message_to_csv,
    message_to_ordereddict,
    message_to_yaml,
    set_message_fields,
)
from rosidl_runtime_py.utilities import get_action, get_interface, get_message, get_service, is_message
from std_srvs.srv import Trigger

from course_lib.ros.messages.idl import NamespacedType


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
    assert message_to_yaml(stamped, flow_style=True).startswith("header:\n  stamp:\n    sec: 0\n")
    assert message_to_csv(stamped) == "0,0,a long frame,1.5,0.0,0.0"
    assert message_to_csv(stamped, no_str=True) == "0,0,<string length: <12>>,1.5,0.0,0.0"


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, restored_packages: None) -> Path:
    """A workspace with one package of interfaces and one without."""
    for name in ("listed_msgs/package.xml", "plain/package.xml"):
        (tmp_path / "src" / name).parent.mkdir(parents=True)
        (tmp_path / "src" / name).write_text(f"<package><name>{Path(name).parent}</name></package>")
    for file, text in {"msg/A.msg": "float64 x", "srv/B.srv": "---", "action/C.action": "---\n---"}.items():
        path = tmp_path / "src" / "listed_msgs" / file
        path.parent.mkdir()
        path.write_text(text)
    monkeypatch.chdir(tmp_path / "src")
    return tmp_path / "src"


def test_interfaces_are_listed_by_package_as_in_rosidl(workspace: Path) -> None:
    assert get_interfaces(["listed_msgs"]) == {"listed_msgs": ["msg/A", "srv/B", "action/C"]}
    assert get_message_interfaces(["listed_msgs", "std_srvs"]) == {"listed_msgs": ["msg/A"]}
    assert get_service_interfaces(["std_srvs"]) == {"std_srvs": ["srv/Empty", "srv/SetBool", "srv/Trigger"]}
    assert get_action_interfaces(["listed_msgs", "plain", "rclpy"]) == {"listed_msgs": ["action/C"]}
    everything = get_interfaces()
    assert "msg/String" in everything["std_msgs"]
    assert "srv/B" in everything["listed_msgs"]
    assert "plain" not in everything
    assert set(get_interface_packages()) == set(everything)
    assert get_interface_packages()["listed_msgs"] == str(workspace)
    for function in (get_interfaces, get_message_interfaces, get_service_interfaces, get_action_interfaces):
        with pytest.raises(LookupError, match=r"^Unknown package 'no_msgs'$"):
            function(["no_msgs"])


def test_path_of_an_interface_is_its_file_in_the_workspace(workspace: Path) -> None:
    message = str(workspace / "listed_msgs" / "msg" / "A.msg")
    assert get_interface_path("listed_msgs/msg/A") == get_interface_path("listed_msgs/msg/A.msg") == message
    assert get_interface_path("listed_msgs/action/C") == str(workspace / "listed_msgs/action/C.action")


@pytest.mark.parametrize(
    ("name", "error", "text"),
    [
        ("String", ValueError, "Expected at least two parts separated by '/'"),
        ("std_msgs//String", ValueError, "Must not contain empty parts"),
        ("std_msgs/../String", ValueError, r"Must not contain '\.\.'"),
        ("no_msgs/msg/A", LookupError, "^Unknown package 'no_msgs'$"),
        ("listed_msgs/msg/B", LookupError, r"^Could not find the interface '.*/listed_msgs/msg/B\.idl'$"),
        ("std_msgs/msg/String", LookupError, "`ros2 interface show std_msgs/msg/String` prints one$"),
    ],
)
def test_path_of_an_unknown_interface_raises_the_error_of_rosidl(
    workspace: Path, name: str, error: type[Exception], text: str
) -> None:
    with pytest.raises(error, match=text):
        get_interface_path(name)


def test_message_classes_are_imported_by_the_types_of_fields() -> None:
    slot_types = get_message_slot_types(PointStamped())
    assert list(slot_types) == ["header", "point"]
    assert import_message_from_namespaced_type(slot_types["point"]) is type(PointStamped().point)
    feedback = NamespacedType(["example_interfaces", "action"], "Fibonacci_FeedbackMessage")
    assert (
        import_message_from_namespaced_type(feedback)
        is get_action("example_interfaces/Fibonacci").Impl.FeedbackMessage
    )
