"""Launch files as public repositories write them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from ament_index_python import get_package_share_path

from course_lib.ros.messages import deserialize, message_class
from tests.ros.launch.run import recorded

Write = Callable[..., Path]
INNER = '<launch><arg name="who" default="nobody"/><log message="hello $(var who)"/></launch>'
TINY = '<robot name="$(arg name)" xmlns:xacro="http://wiki.ros.org/xacro"><link name="base_link"/></robot>'


def logged(file: Path, capsys: pytest.CaptureFixture[str], *args: str, seconds: float = 1.0) -> list[str]:
    assert recorded(file, *args, seconds=seconds)[1] == 0
    lines = capsys.readouterr().out.splitlines()
    return [line.partition("]: ")[2] for line in lines if "launch.user" in line]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("outer.launch.xml", '<launch><include file="$(dirname)/in/inner.launch.xml">{}</include></launch>'),
        ("outer.launch.yaml", "launch:\n- include:\n    file: $(dirname)/in/inner.launch.xml\n{}"),
    ],
)
@pytest.mark.parametrize("tag", ["let", "arg"])
def test_let_and_arg_elements_in_an_include_set_its_arguments(
    name: str, text: str, tag: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    inner = tmp_path / "in" / "inner.launch.xml"
    inner.parent.mkdir()
    inner.write_text(INNER)
    is_xml = name.endswith("xml")
    given = (
        f'<{tag} name="who" value="world"/>' if is_xml else f"    {tag}:\n    - {{name: who, value: world}}\n"
    )
    (tmp_path / name).write_text(text.format(given))
    assert logged(tmp_path / name, capsys) == ["hello world"]


@pytest.mark.parametrize("command", ["$(exec-in-pkg xacro xacro)", "xacro", "$(find-exec xacro)"])
def test_kit_executable_has_a_path_in_its_package(command: str, tmp_path: Path) -> None:
    (tmp_path / "tiny.xacro").write_text(TINY)
    (tmp_path / "tiny.launch.xml").write_text(
        '<launch><node pkg="robot_state_publisher" exec="robot_state_publisher">'
        '<param name="robot_description" '
        f'type="str" value="$(command \'{command} $(dirname)/tiny.xacro name:=t\')"/></node></launch>'
    )
    recording, code = recorded(tmp_path / "tiny.launch.xml")
    assert code == 0
    assert "/robot_description" in [topic.name for topic in recording.topics()]


def test_included_file_generated_by_cmake_is_skipped(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "made.launch.py.in").touch()
    include = '<include file="$(dirname)/made.launch.py"/>'
    (tmp_path / "a.launch.xml").write_text(f'<launch>{include}<log message="goes on"/></launch>')
    recorded(tmp_path / "a.launch.xml")
    output = capsys.readouterr().out
    assert "is left out: " in output
    assert "made.launch.py is made from made.launch.py.in when its package is built by CMake." in output
    assert "goes on" in output


def test_ros2_pkg_command_runs_while_a_launch_file_is_read(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "src" / "arm").mkdir(parents=True)
    manifest = "<package format='3'><name>arm</name><version>4.5.6</version></package>"
    (tmp_path / "src" / "arm" / "package.xml").write_text(manifest)
    (tmp_path / "a.launch.xml").write_text(
        "<launch><log message=\"$(command 'ros2 pkg xml -t version arm')\"/></launch>"
    )
    assert logged(tmp_path / "a.launch.xml", capsys) == ["4.5.6"]


MODULES = """
import launch
import launch_ros

def generate_launch_description():
    substitution = launch_ros.substitutions.FindPackageShare("demo_nodes_py")
    launch_ros.descriptions, launch_ros.event_handlers, launch_ros.events
    launch.events.process.ProcessExited, launch.events.matchers, launch.conditions, launch.descriptions
    return launch.LaunchDescription([
        launch_ros.actions.Node(package="demo_nodes_py", executable="talker"),
        launch.actions.LogInfo(msg="done"),
    ])
"""


def test_import_of_a_bare_package_provides_its_modules(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.launch.py").write_text(MODULES)
    assert logged(tmp_path / "a.launch.py", capsys) == ["done"]


POSES = """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo
from nav2_common.launch import LaunchConfigAsBool, ParseMultiRobotPose

def generate_launch_description():
    robots = ParseMultiRobotPose("robots").value()
    return LaunchDescription([
        DeclareLaunchArgument("sim", default_value="1"),
        *(
            LogInfo(msg=[name, f" {pose['x']} {pose['yaw']} ", LaunchConfigAsBool("sim")])
            for name, pose in robots.items()
        ),
    ])
"""


def test_poses_of_several_robots_are_read_from_the_command_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "p.launch.py").write_text(POSES)
    given = "robots:=a={x: 1.0}; b={x: 2.0, yaw: 0.5}"
    assert logged(tmp_path / "p.launch.py", capsys, given) == ["a 1.0 0.0 True", "b 2.0 0.5 True"]
    assert logged(tmp_path / "p.launch.py", capsys, given, "sim:=off") == [
        "a 1.0 0.0 False",
        "b 2.0 0.5 False",
    ]


def test_display_of_urdf_launch_shows_a_description_of_a_package(robot: Path) -> None:
    (robot / "config" / "tiny.urdf").write_text('<robot name="t"><link name="base_link"/></robot>')
    (robot / "launch" / "show.launch.xml").write_text(
        '<launch><include file="$(find-pkg-share urdf_launch)/launch/display.launch.py">'
        '<let name="urdf_package" value="my_robot"/><let name="urdf_package_path" value="config/tiny.urdf"/>'
        '<let name="jsp_gui" value="false"/></include></launch>'
    )
    recording, code = recorded(robot / "launch" / "show.launch.xml")
    assert code == 0
    assert "/robot_description" in [topic.name for topic in recording.topics()]


@pytest.mark.parametrize(
    ("model", "links"),
    [("", 1), ("urdf/06-flexible.urdf", 6), ("own", 1)],
)
def test_display_launch_of_urdf_tutorial_shows_its_robots_and_custom_robots(
    model: str, links: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    own = tmp_path / "own.urdf"
    own.write_text('<robot name="t"><link name="base_link"/></robot>')
    words = [f"model:={own if model == 'own' else model}"] if model else []
    launch = get_package_share_path("urdf_tutorial") / "launch" / "display.launch.py"
    recording, code = recorded(launch, *words, "gui:=false")
    (description,) = (s for s in recording.samples if s.topic == "/robot_description")
    text: Any = deserialize(description.cdr, message_class("std_msgs/msg/String"))
    assert (code, text.data.count("<link ")) == (0, links)
    assert "left out" not in capsys.readouterr().out


def test_messages_of_create_robots_and_of_goals_can_be_imported() -> None:
    from irobot_create_msgs.action import DriveDistance
    from irobot_create_msgs.msg import HazardDetection, HazardDetectionVector
    from irobot_create_msgs.srv import EStop
    from nav_msgs.msg import Goals

    bump = HazardDetection(type=HazardDetection.BUMP)
    assert HazardDetectionVector(detections=[bump]).detections[0].type == 1
    assert DriveDistance.Goal().max_translation_speed == 0.3
    assert EStop.Request(e_stop_on=True).e_stop_on
    assert list(Goals().goals) == []


def test_attributes_of_the_root_are_ignored(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.launch.xml").write_text('<launch version="0.1.1"><log message="done"/></launch>')
    assert logged(tmp_path / "a.launch.xml", capsys) == ["done"]


MATCHERS = """
from launch import LaunchDescription
from launch.actions import EmitEvent, LogInfo, RegisterEventHandler, TimerAction
from launch.event_handlers import OnProcessExit, OnProcessIO
from launch.events.process import *
from launch_ros.actions import Node

def generate_launch_description():
    nodes = [
        Node(package="demo_nodes_py", executable="talker", name=name) for name in ("a", "b")
    ]
    exits = [
        RegisterEventHandler(OnProcessExit(target_action=node, on_exit=[LogInfo(msg=name)]))
        for node, name in zip(nodes, ("first", "second"))
    ]
    streams = set()

    def on_line(event):
        kind = type(event).__name__
        assert isinstance(event, ProcessIO)
        if kind not in streams:
            streams.add(kind)
            return LogInfo(msg=kind)

    stop = ShutdownProcess(process_matcher=MATCHER)
    return LaunchDescription([
        *nodes, *exits,
        RegisterEventHandler(OnProcessIO(target_action=nodes[0], on_stdout=on_line, on_stderr=on_line)),
        TimerAction(period=1.2, actions=[EmitEvent(event=stop)]),
        TimerAction(period=1.5, actions=[LogInfo(msg="later")]),
    ])
"""


@pytest.mark.parametrize(
    ("matcher", "before"),
    [
        ('matches_name("talker-1")', ["first"]),
        ("matches_pid(2)", ["second"]),
        ('matches_executable("talker-2")', ["second"]),
        ('matches_name("talker")', []),
    ],
)
def test_matcher_of_a_process_selects_it_by_its_details(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], matcher: str, before: list[str]
) -> None:
    (tmp_path / "a.launch.py").write_text(MATCHERS.replace("MATCHER)", f"{matcher})"))
    lines = logged(tmp_path / "a.launch.py", capsys, seconds=2.0)
    assert lines[0] == "ProcessStderr"
    assert lines[1 : lines.index("later")] == before


UTILITIES = """
from launch import LaunchDescription, SomeEntitiesType
from launch.actions import LogInfo, OpaqueFunction
from launch.some_entities_type import SomeEntitiesType
from launch.substitutions import LaunchConfiguration
from launch.utilities import is_a, is_a_subclass, normalize_to_list_of_entities
from launch_ros.parameters_type import SomeParameters
from launch_ros.remap_rule_type import SomeRemapRules
from launch_ros.utilities import (
    evaluate_parameters, make_namespace_absolute, normalize_parameters, normalize_remap_rules,
    prefix_namespace,
)

def setup(context):
    rate = LaunchConfiguration("rate", default="2")
    given = normalize_parameters([{"a": {"rate": rate, "list": [1.0, 2.0]}}, "p.yaml"])
    values, file = evaluate_parameters(context, given)
    spaces = [("/my", "own"), ("my", "/own"), (None, "own/"), ("/", "own"), ("my", None), ("my", "")]
    spaces.append((None, None))
    rules = list(normalize_remap_rules([("from", ["to_", rate])]))
    return normalize_to_list_of_entities([
        LogInfo(msg=str(values)),
        [LogInfo(msg=str(file)), LogInfo(msg=str([prefix_namespace(*pair) for pair in spaces]))],
        LogInfo(msg=str([len(names) for names in rules[0]])),
        LogInfo(msg=make_namespace_absolute("x")),
        LogInfo(msg=str([is_a(rate, LaunchConfiguration), is_a_subclass(bool, int), is_a_subclass("", int)])),
    ])

def generate_launch_description():
    return LaunchDescription([OpaqueFunction(function=setup)])
"""


def test_functions_for_custom_launch_files_return_the_values_of_ros(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.launch.py").write_text(UTILITIES)
    assert logged(tmp_path / "a.launch.py", capsys) == [
        "{'a.rate': 2, 'a.list': (1.0, 2.0)}",
        "p.yaml",
        "['/my/own', '/own', 'own', '/own', 'my', 'my', None]",
        "[1, 2]",
        "/x",
        "[True, True, False]",
    ]


def test_action_that_a_function_adds_to_the_visited_description_runs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "a.launch.py").write_text("""
from launch import LaunchDescription
from launch.actions import LogInfo, OpaqueFunction

def add(context, description):
    description.add_action(LogInfo(msg="added"))

def generate_launch_description():
    description = LaunchDescription()
    description.add_action(OpaqueFunction(function=add, args=[description]))
    return description
""")
    assert logged(tmp_path / "a.launch.py", capsys) == ["added"]
