import copy
import math
import pickle
from array import array
from inspect import signature
from typing import Any

import numpy as np
import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from geometry_msgs.msg import Point, Pose, PoseWithCovariance, Quaternion
from rcl_interfaces.msg import ParameterDescriptor, ParameterType
from sensor_msgs.msg import Image, JointState, NavSatStatus
from std_msgs.msg import ColorRGBA, Float64MultiArray, Header, String
from visualization_msgs.msg import Marker, MarkerArray

from course_lib.ros.messages import RosMessage
from course_lib.ros.messages.definitions import DEFAULTS
from course_lib.ros.messages.message import message_class


def test_default_values_agree_with_the_msg_files() -> None:
    assert (Quaternion().x, Quaternion().w) == (0.0, 1.0)
    assert NavSatStatus().status == NavSatStatus.STATUS_UNKNOWN == -2
    assert ParameterDescriptor().read_only is False
    assert DiagnosticStatus().level == DiagnosticStatus.OK == b"\x00"
    assert Marker().pose.orientation.w == Quaternion.W__DEFAULT == 1.0


@pytest.mark.parametrize(("type_name", "field"), DEFAULTS)
def test_every_default_value_belongs_to_a_field_and_has_its_type(type_name: str, field: str) -> None:
    message = message_class(type_name)()
    setattr(message, field, getattr(message, field))
    assert getattr(message, field) == DEFAULTS[type_name, field]


def test_fields_are_passed_by_keyword_only() -> None:
    assert Point(x=1.0, z=3.0) == Point(x=1.0, y=0.0, z=3.0)
    text = r"Point.__init__\(\) takes 1 positional argument but 3 were given"
    with pytest.raises(TypeError, match=text):
        Point(1.0, 2.0)  # type: ignore[call-arg]


def test_unknown_field_is_rejected_with_ros_text() -> None:
    with pytest.raises(AttributeError, match=r"^'String' object has no attribute 'dat'"):
        String().dat = "x"  # type: ignore[attr-defined]
    with pytest.raises(AssertionError, match=r"^Invalid arguments passed to constructor: dat, zap$"):
        String(zap=1, dat="x")  # type: ignore[call-arg]


def test_unchecked_messages_accept_any_value_as_in_jazzy() -> None:
    point = Point(check_fields=False, x=1)
    point.y = 2
    assert (point.x, point.y) == (1, 2)


def test_constants_are_available_on_class_and_instance() -> None:
    assert (Marker.CUBE, Marker().CUBE, Marker.DELETEALL) == (1, 1, 3)
    assert ParameterType.PARAMETER_STRING == 4
    with pytest.raises(AttributeError):
        Marker().CUBE = 5  # type: ignore[misc]
    with pytest.raises(AttributeError, match="property 'CUBE' of 'Metaclass_Marker' object has no setter"):
        Marker.CUBE = 5  # type: ignore[misc]


def test_field_set_on_a_class_does_not_change_its_messages() -> None:
    marker: Any = Marker
    marker.header, marker.points = Header(frame_id="map"), [Point()]
    assert (Marker(id=3).id, Marker().points, Marker().header.frame_id) == (3, [], "")
    marker.note = "an attribute of its own"
    assert marker.note == "an attribute of its own"
    del marker.note


def test_repr_agrees_with_ros() -> None:
    assert repr(String(data="x")) == "std_msgs.msg.String(data='x')"
    stamp = "builtin_interfaces.msg.Time(sec=1, nanosec=2)"
    header = Header(stamp=Time(sec=1, nanosec=2), frame_id="map")
    assert repr(header) == f"std_msgs.msg.Header(stamp={stamp}, frame_id='map')"
    joints = repr(JointState(name=["a"], position=[0.5, 1.0]))
    assert joints.endswith("name=['a'], position=[0.5, 1.0], velocity=[], effort=[])")


def test_equality_compares_fields() -> None:
    assert Pose() == Pose()
    assert Pose() != Pose(position=Point(x=1.0))
    assert String(data="x") != "x"
    one, other = PoseWithCovariance(), PoseWithCovariance()
    assert one == other
    other.covariance[7] = 1.0
    assert one != other


def test_messages_are_unhashable() -> None:
    with pytest.raises(TypeError, match="unhashable type: 'Point'"):
        hash(Point())


def test_field_types_are_spelled_as_in_ros() -> None:
    assert String.get_fields_and_field_types() == {"data": "string"}
    types = Marker.get_fields_and_field_types()
    assert types["points"] == "sequence<geometry_msgs/Point>"
    assert types["header"] == "std_msgs/Header"
    assert types["frame_locked"] == "boolean"
    assert PoseWithCovariance.get_fields_and_field_types()["covariance"] == "double[36]"
    assert DiagnosticStatus.get_fields_and_field_types()["level"] == "octet"
    primitive = message_class("shape_msgs/msg/SolidPrimitive").get_fields_and_field_types()
    assert primitive["dimensions"] == "sequence<double, 3>"
    assert message_class("rmw_dds_common/msg/NodeEntitiesInfo").get_fields_and_field_types()[
        "node_namespace"
    ] == ("string<256>")


def test_signature_lists_the_fields_for_completion() -> None:
    assert list(signature(String).parameters) == ["data"]


def test_slots_agree_with_rosidl() -> None:
    assert list(ColorRGBA.__slots__) == ["_r", "_g", "_b", "_a", "_check_fields"]
    assert not hasattr(ColorRGBA(), "__dict__")


def test_class_has_the_module_name_of_rosidl() -> None:
    assert str(String) == "<class 'std_msgs.msg._string.String'>"
    assert message_class("std_msgs/msg/UInt8MultiArray").__module__ == "std_msgs.msg._u_int8_multi_array"


def test_deepcopy_and_pickle_give_equal_independent_messages() -> None:
    marker = Marker(ns="a", points=[Point(x=1.0)])
    for twin in (copy.deepcopy(marker), pickle.loads(pickle.dumps(marker))):
        assert twin == marker
        twin.points[0].x = 2.0
        assert marker.points[0].x == 1.0


def test_deepcopy_keeps_subclass_attributes_and_shared_references() -> None:
    class Named(Point):
        pass

    named = Named(x=1.0)
    named.notes = ["a"]  # type: ignore[attr-defined]
    twins = copy.deepcopy([named, named])
    assert twins[0] is twins[1]
    assert twins[0] is not named
    assert (twins[0].x, vars(twins[0])) == (1.0, {"notes": ["a"]})
    assert vars(twins[0])["notes"] is not vars(named)["notes"]


def test_deepcopy_does_not_use_pickle(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(RosMessage, "__reduce_ex__", lambda *_: pytest.fail("pickled"))
    assert copy.deepcopy(Marker(points=[Point(x=1.0)])) == Marker(points=[Point(x=1.0)])


def test_constructors_copy_arrays_of_numbers_and_keep_messages_and_lists() -> None:
    values, covariance = array("d", [1.0]), np.zeros(36)
    points = [Point()]
    message = Float64MultiArray(data=values)
    pose = PoseWithCovariance(covariance=covariance)
    values[0], covariance[0] = 5.0, 5.0
    assert message.data[0] == 1.0
    assert pose.covariance[0] == 0.0
    assert Marker(points=points).points is points


def test_setters_keep_the_assigned_array() -> None:
    values = array("d", [1.0])
    message = Float64MultiArray()
    message.data = values
    assert message.data is values


def test_numeric_sequences_become_array_array() -> None:
    image = Image(data=b"\x01\x02")
    assert image.data == array("B", [1, 2])
    image.data = [3, 4]
    image.data.extend([5])
    assert image.data.tolist() == [3, 4, 5]
    assert isinstance(PoseWithCovariance(covariance=[0.0] * 36).covariance, np.ndarray)


def test_defaults_are_not_shared() -> None:
    one, other = MarkerArray(), MarkerArray()
    one.markers.append(Marker())
    assert other.markers == []


def test_field_named_type_does_not_hide_the_builtin() -> None:
    assert Marker(type=2, ns="a", frame_locked=True).type == 2


def test_constructor_checks_values_in_the_setters_unless_check_fields_is_false() -> None:
    assert Point(x=math.inf, y=-0.0).x == math.inf
    with pytest.raises(AssertionError, match="'z' field must be of type 'float'"):
        Point(x=1.0, z=1)
    with pytest.raises(AssertionError, match="'a' field must be a float in"):
        ColorRGBA(a=1e39)
    assert Point(x=1, check_fields=False).x == 1
