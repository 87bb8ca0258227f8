from pathlib import PurePath
from typing import Any

import pytest
from moveit_msgs.msg import RobotState
from nav2_msgs.action import NavigateToPose
from rosbags.typesys import Stores, get_typestore

from course_lib.ros.messages import deserialize, interface_files, serialize
from course_lib.ros.messages.definitions import definition, type_names, typestore
from course_lib.ros.messages.interface_files import LazyTypes, kit_files


def test_interface_file_is_parsed_when_one_of_its_types_is_looked_up(monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[str] = []
    original = interface_files.parse_interface

    def spy(text: str, file: str) -> dict[str, Any]:
        read.append(PurePath(file).stem)
        return original(text, file)

    monkeypatch.setattr("course_lib.ros.messages.interface_files.parse_interface", spy)
    files = {"a_msgs/msg/One.msg": "uint8 number 7", "a_msgs/srv/Two.srv": "---\nbool ok"}
    defaults: dict[tuple[str, str], object] = {}
    types = LazyTypes({"b_msgs/msg/Known": ([], [])}, files, defaults)
    names = {"a_msgs/msg/One", "a_msgs/srv/Two_Request", "a_msgs/srv/Two_Response", "b_msgs/msg/Known"}
    assert (set(types), len(types), read) == (names, 4, [])
    assert "a_msgs/srv/Two_Response" in types
    assert [name for name, _ in types["a_msgs/srv/Two_Response"][1]] == ["ok"]
    assert types["a_msgs/msg/One"][1][0][0] == "number"
    assert (read, defaults) == (["Two", "One"], {("a_msgs/msg/One", "number"): 7})


def test_names_in_an_interface_file_are_the_types_it_defines() -> None:
    for file, text in kit_files().items():
        defined = interface_files.parse_interface(text, file)
        assert set(interface_files.type_names_in(file)) == set(defined), file


def test_every_message_field_has_a_known_type() -> None:
    for name in type_names():
        for field in definition(name).fields:
            assert not field.is_message or field.base in typestore().fielddefs, (name, field.name)


def test_rosbags_types_are_not_defined_twice() -> None:
    known = get_typestore(Stores.ROS2_JAZZY).fielddefs
    own = {name for file in kit_files() for name in interface_files.type_names_in(file)}
    assert own & known.keys() == set()


def test_types_of_large_packages_survive_serialization_with_their_defaults() -> None:
    state = RobotState()
    state.multi_dof_joint_state.joint_names = ["base"]
    assert deserialize(serialize(state), RobotState) == state
    goal = NavigateToPose.Goal(behavior_tree="straight.xml")
    assert goal.pose.pose.orientation.w == 1.0
    assert deserialize(serialize(goal), NavigateToPose.Goal) == goal
