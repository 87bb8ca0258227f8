from array import array
from pathlib import Path
from struct import Struct
from typing import Any

import pytest
from sensor_msgs.msg import JointState

from course_lib.errors import CourseError
from course_lib.ros.messages import deserialize, message_class, serialize
from course_lib.ros.messages.cdr import BIG, LITTLE, packer, unpacker
from course_lib.ros.messages.definitions import add_package, typestore


def test_adjacent_numbers_are_written_by_one_call() -> None:
    calls = [
        getattr(value, "__self__", None) for value in packer("geometry_msgs/msg/Pose").__globals__.values()
    ]
    assert [call.format for call in calls if isinstance(call, Struct)] == ["<I", "<ddddddd"]


@pytest.mark.parametrize("order", [LITTLE, BIG])
def test_list_longer_than_the_received_data_is_rejected_immediately(order: str) -> None:
    front = b"\0\1\0\0" if order == LITTLE else b"\0\0\0\0"
    many = (2**32 - 1).to_bytes(4, "little" if order == LITTLE else "big")
    for type_name in ("std_msgs/msg/Float64MultiArray", "sensor_msgs/msg/JointState", "nav_msgs/msg/Path"):
        cdr = front + bytes(12) + many + bytes(8)
        with pytest.raises(CourseError, match="bytes are no"):
            deserialize(cdr, message_class(type_name))


def test_array_of_another_type_code_is_converted() -> None:
    state = JointState(check_fields=False)
    state.position = array("f", [1.5])
    assert deserialize(serialize(state), JointState).position == array("d", [1.5])


def test_nested_empty_messages_keep_the_alignment_of_their_neighbors(tmp_path: Path) -> None:
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


def test_big_endian_functions_are_compiled_for_the_first_big_endian_message() -> None:
    cls: Any = message_class("std_msgs/msg/Int16")
    serialize(cls(data=258)), deserialize(serialize(cls(data=258)), cls)
    before = unpacker.cache_info().currsize
    assert deserialize(b"\0\0\0\0\1\2", cls).data == 258
    assert unpacker.cache_info().currsize == before + 1


def test_field_named_like_a_serializer_variable_keeps_its_value(tmp_path: Path) -> None:
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
