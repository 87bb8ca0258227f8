"""Service types have the structure that rosidl generates."""

import pickle

import pytest
from example_interfaces.srv import AddTwoInts
from rcl_interfaces.srv import ListParameters
from std_srvs.srv import Empty, SetBool

from course_lib.errors import CourseError
from course_lib.ros.messages import deserialize, serialize, service_class


def test_service_request_agrees_with_ros() -> None:
    request = AddTwoInts.Request(a=1, b=2)
    assert repr(request) == "example_interfaces.srv.AddTwoInts_Request(a=1, b=2)"
    assert AddTwoInts.Request.__module__ == AddTwoInts.__module__ == "example_interfaces.srv._add_two_ints"
    assert repr(AddTwoInts.Response(sum=3)) == "example_interfaces.srv.AddTwoInts_Response(sum=3)"


def test_service_class_cannot_be_instantiated() -> None:
    with pytest.raises(NotImplementedError, match=r"^Service classes can not be instantiated$"):
        AddTwoInts()


def test_requests_are_checked_like_messages() -> None:
    with pytest.raises(AssertionError, match=r"^The 'a' field must be of type 'int'$"):
        AddTwoInts.Request(a=1.5)  # type: ignore[arg-type]  # the mistake that is tested
    with pytest.raises(AttributeError, match=r"'AddTwoInts_Request' object has no attribute 'c'"):
        AddTwoInts.Request().c = 1  # type: ignore[attr-defined]  # the mistake that is tested


@pytest.mark.parametrize(
    "part", [AddTwoInts.Request(a=-1, b=2**62), Empty.Request(), SetBool.Response(success=True, message="on")]
)
def test_service_part_survives_serialization_and_pickling(part: Empty.Request) -> None:
    assert deserialize(serialize(part), type(part)) == part
    assert pickle.loads(pickle.dumps(part)) == part


def test_empty_request_or_response_is_serialized_as_one_byte_as_in_ros() -> None:
    assert len(serialize(Empty.Request())) == 4 + 1


def test_constants_belong_to_their_request_or_response() -> None:
    assert ListParameters.Request.DEPTH_RECURSIVE == 0


def test_unknown_service_type_error_suggests_close_matches() -> None:
    with pytest.raises(CourseError, match=r"std_srvs/srv/Trigger_Request"):
        service_class("std_srvs/srv/Triger")
