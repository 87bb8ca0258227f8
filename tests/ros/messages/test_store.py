from pathlib import Path
from typing import Any

import pytest
from rosbags.serde.cdr import generate_deserialize_cdr
from sensor_msgs.msg import JointState

from course_lib.ros.messages import deserialize, message_class, serialize
from course_lib.ros.messages.definitions import add_package, typestore
from course_lib.ros.messages.kinds import CONVERTED
from course_lib.ros.messages.store import CdrStore
from course_lib.ros.messages.wire import _store_with

STATE = JointState(name=["a", "b"], position=[1.0, 2.0])


def functions(store: CdrStore) -> tuple[str, ...]:
    return store.get_msgdef("sensor_msgs/msg/JointState").getsize_cdr.__code__.co_names


def test_the_size_of_a_message_is_found_without_converting_its_fields() -> None:
    names = functions(_store_with("sensor_msgs/msg/JointState"))
    assert "_position" in names
    assert not [name for name in names if name.startswith(CONVERTED)]


def test_one_function_reads_and_writes_a_message_with_the_messages_in_its_fields() -> None:
    functions = _store_with("geometry_msgs/msg/TransformStamped").get_msgdef(
        "geometry_msgs/msg/TransformStamped"
    )
    for function in (functions.getsize_cdr, functions.serialize_cdr_le, functions.deserialize_cdr_le):
        assert "get_msgdef" not in function.__code__.co_names


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


def test_big_endian_functions_are_compiled_when_such_a_message_comes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "swapped_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Swapped.msg").write_text("int32 x\n")
    add_package(folder.parent)
    swapped: Any = message_class("swapped_msgs/msg/Swapped")
    orders: list[str] = []
    compiled = "course_lib.ros.messages.store.generate_deserialize_cdr"

    def generate(entries: Any, store: Any, order: str) -> Any:
        orders.append(order)
        return generate_deserialize_cdr(entries, store, order)

    monkeypatch.setattr(compiled, generate)
    try:
        assert deserialize(serialize(swapped(x=258)), swapped).x == 258
        assert orders == ["le"]
        assert deserialize(b"\0\0\0\0\0\0\1\2", swapped).x == 258
        assert orders == ["le", "be"]
    finally:
        del typestore().fielddefs["swapped_msgs/msg/Swapped"]


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


def test_functions_for_ros_1_are_not_compiled() -> None:
    definition = _store_with("sensor_msgs/msg/JointState").get_msgdef("sensor_msgs/msg/JointState")
    with pytest.raises(NotImplementedError):
        definition.serialize_ros1(memoryview(b""), 0, STATE, _store_with("sensor_msgs/msg/JointState"))
