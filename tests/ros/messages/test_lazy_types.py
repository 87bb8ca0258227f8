from pathlib import Path
from typing import Any

import pytest
from moveit_msgs.msg import RobotState
from nav2_msgs.action import NavigateToPose
from rosbags.typesys import Stores, get_typestore

from course_lib.ros.messages import deserialize, interface_files, serialize
from course_lib.ros.messages.definitions import FOLDERS, definition, type_names, typestore
from course_lib.ros.messages.interface_files import LazyTypes


def write(folder: Path, name: str, text: str) -> None:
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


def test_a_file_is_read_when_one_of_its_types_is_looked_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read: list[str] = []
    original = interface_files.read_interface

    def spy(path: Path) -> dict[str, Any]:
        read.append(path.stem)
        return original(path)

    monkeypatch.setattr("course_lib.ros.messages.interface_files.read_interface", spy)
    write(tmp_path, "a_msgs/msg/One.msg", "uint8 number 7")
    write(tmp_path, "a_msgs/srv/Two.srv", "---\nbool ok")
    defaults: dict[tuple[str, str], object] = {}
    types = LazyTypes({"b_msgs/msg/Known": ([], [])}, tmp_path, defaults)
    names = {"a_msgs/msg/One", "a_msgs/srv/Two_Request", "a_msgs/srv/Two_Response", "b_msgs/msg/Known"}
    assert (set(types), len(types), read) == (names, 4, [])
    assert "a_msgs/srv/Two_Response" in types
    assert [name for name, _ in types["a_msgs/srv/Two_Response"][1]] == ["ok"]
    assert types["a_msgs/msg/One"][1][0][0] == "number"
    assert (read, defaults) == (["Two", "One"], {("a_msgs/msg/One", "number"): 7})


def test_every_name_of_a_file_is_what_its_text_defines() -> None:
    for path in FOLDERS[0].glob("*/*/*.*"):
        assert set(interface_files.names_in(path)) == set(interface_files.read_interface(path)), path


def test_every_field_that_holds_a_message_holds_a_known_one() -> None:
    for name in type_names():
        for field in definition(name).fields:
            assert not field.is_message or field.base in typestore().fielddefs, (name, field.name)


def test_rosbags_own_types_are_not_defined_a_second_time() -> None:
    known = get_typestore(Stores.ROS2_JAZZY).fielddefs
    own = {name for path in FOLDERS[0].glob("*/*/*.*") for name in interface_files.names_in(path)}
    assert own & known.keys() == set()


def test_types_of_large_packages_survive_the_wire_with_their_defaults() -> None:
    state = RobotState()
    state.multi_dof_joint_state.joint_names = ["base"]
    assert deserialize(serialize(state), RobotState) == state
    goal = NavigateToPose.Goal(behavior_tree="straight.xml")
    assert goal.pose.pose.orientation.w == 1.0
    assert deserialize(serialize(goal), NavigateToPose.Goal) == goal
