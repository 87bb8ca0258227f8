from array import array
from pathlib import Path
from struct import Struct
from typing import Any

import pytest
from sensor_msgs.msg import JointState

from course_lib.errors import CourseError
from course_lib.ros.messages import deserialize, message_class, serialize
from course_lib.ros.messages.cdr_layout import BIG, LITTLE
from course_lib.ros.messages.cdr_reader import unpacker
from course_lib.ros.messages.cdr_writer import packer
from course_lib.ros.messages.definitions import add_package, typestore


def test_numbers_that_lie_side_by_side_are_written_by_one_call() -> None:
    calls = [
        getattr(value, "__self__", None) for value in packer("geometry_msgs/msg/Pose").__globals__.values()
    ]
    assert [call.format for call in calls if isinstance(call, Struct)] == ["<I", "<ddddddd"]


@pytest.mark.parametrize("order", [LITTLE, BIG])
def test_a_list_that_claims_more_than_came_is_refused_at_once(order: str) -> None:
    front = b"\0\1\0\0" if order == LITTLE else b"\0\0\0\0"
    many = (2**32 - 1).to_bytes(4, "little" if order == LITTLE else "big")
    for type_name in ("std_msgs/msg/Float64MultiArray", "sensor_msgs/msg/JointState", "nav_msgs/msg/Path"):
        cdr = front + bytes(12) + many + bytes(8)
        with pytest.raises(CourseError, match="bytes are no"):
            deserialize(cdr, message_class(type_name))


def test_an_array_of_other_numbers_is_refused_when_sent_unchecked() -> None:
    state = JointState(check_fields=False)
    state.position = array("f", [1.0])
    with pytest.raises(AssertionError, match="type code of 'd'"):
        serialize(state)


def test_messages_without_fields_in_fields_keep_their_neighbours_in_place(tmp_path: Path) -> None:
    folder = tmp_path / "hollow_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Hollow.msg").write_text("int8 a\nstd_msgs/Empty none\nfloat64 b\nstd_msgs/Empty[] list\n")
    add_package(folder.parent)
    hollow, empty = message_class("hollow_msgs/msg/Hollow"), message_class("std_msgs/msg/Empty")
    message = hollow(a=1, b=2.5, list=[empty(), empty()])
    try:
        data, store, name = serialize(message), typestore(), "hollow_msgs/msg/Hollow"
        assert deserialize(data, hollow) == message
        assert bytes(store.serialize_cdr(store.deserialize_cdr(data, name), name)) == data
    finally:  # other tests look at all types
        del typestore().fielddefs["hollow_msgs/msg/Hollow"]


def test_functions_for_big_endian_messages_are_compiled_when_such_a_message_comes() -> None:
    cls: Any = message_class("std_msgs/msg/Int16")
    serialize(cls(data=258)), deserialize(serialize(cls(data=258)), cls)
    before = unpacker.cache_info().currsize
    assert deserialize(b"\0\0\0\0\1\2", cls).data == 258
    assert unpacker.cache_info().currsize == before + 1


def test_a_field_with_the_name_of_what_is_sent_keeps_its_value(tmp_path: Path) -> None:
    folder = tmp_path / "odd_field_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Odd.msg").write_text("float64[] x\nfloat64[] wire_x\nstring wire_y\nstring y\n")
    add_package(folder.parent)
    odd = message_class("odd_field_msgs/msg/Odd")
    message = odd(x=[1.0], wire_x=[2.0, 3.0], wire_y="four", y="five")
    try:
        assert deserialize(serialize(message), odd) == message
    finally:  # other tests look at all types
        del typestore().fielddefs["odd_field_msgs/msg/Odd"]
