"""The table of types that is written at installation agrees with rosbags' store and the files."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from rosbags.typesys import Stores, get_typestore

from course_lib.ros.messages import interface_files
from course_lib.ros.messages.interface_files import LazyTypes, kit_files, read_table
from course_lib.ros.messages.stubs import write_table
from tests.patience import PATIENCE


def test_installed_type_table_equals_rosbags_and_msg_file_definitions() -> None:
    table = read_table()
    assert table is not None, "install the kit again: pip install -e ."
    slow_defaults: dict[tuple[str, str], object] = {}
    fast_defaults: dict[tuple[str, str], object] = {}
    slow = LazyTypes(dict(get_typestore(Stores.ROS2_JAZZY).fielddefs), kit_files(), slow_defaults)
    fast = LazyTypes({}, kit_files(), fast_defaults, table)
    assert dict(fast.items()) == dict(slow.items())
    assert fast_defaults == slow_defaults


def test_table_of_another_rosbags_version_is_not_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(interface_files, "FILE", tmp_path / "types.json")
    assert read_table() is None
    write_table(interface_files.FILE)
    assert read_table() is not None
    content = json.loads(interface_files.FILE.read_text())
    interface_files.FILE.write_text(json.dumps(content | {"rosbags": "0.0.1"}))
    assert read_table() is None


def test_changed_interface_file_is_parsed_again() -> None:
    files = {"a_msgs/msg/One.msg": "uint8 number\n"}
    old = interface_files.TypeTable({}, {"a_msgs/msg/One.msg": (0, {"a_msgs/msg/One": [[], []]}, {})})
    (field,) = LazyTypes({}, files, {}, old)["a_msgs/msg/One"][1]
    assert field[0] == "number"


START = """
import sys, course_lib, rclpy
from std_msgs.msg import String
rclpy.init()
rclpy.create_node("n").create_publisher(String, "t", 10).publish(String(data="x"))
import std_msgs.msg
print(*(name for name in ("rosbags", "typer", "yaml") if name in sys.modules))
print(*(name for name in vars(std_msgs.msg) if name[0].isupper()))
"""


def test_small_node_imports_neither_rosbags_nor_unused_classes() -> None:
    process = subprocess.run(
        [sys.executable, "-c", START],
        capture_output=True,
        text=True,
        check=True,
        env=dict(os.environ),
        timeout=PATIENCE,
    )
    assert process.stdout.splitlines()[0] == ""
    assert process.stdout.splitlines()[1] == "String"


def test_star_import_imports_all_classes() -> None:
    names: dict[str, object] = {}
    exec("from std_msgs.msg import *\nfrom std_srvs.srv import *", names)
    assert {"String", "ColorRGBA", "Trigger"} <= names.keys()
