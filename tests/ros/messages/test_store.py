from pathlib import Path

import pytest
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
