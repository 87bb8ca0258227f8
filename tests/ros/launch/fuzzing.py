"""Malformed launch files, made from well-formed ones by a seed: no traceback has a line of the kit."""

import io
import random
import re
from collections.abc import Iterator
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.ros.student_code import KIT
from tests.ros.launch.run import recorded

PYTHON = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, EmitEvent, ExecuteProcess, GroupAction, LogInfo, TimerAction
from launch.actions import IncludeLaunchDescription, OpaqueFunction, RegisterEventHandler
from launch.actions import SetEnvironmentVariable, SetLaunchConfiguration
from launch.conditions import IfCondition, UnlessCondition
from launch.event_handlers import OnProcessExit, OnProcessStart
from launch.events import Shutdown
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import Command, EnvironmentVariable, LaunchConfiguration, PythonExpression
from launch.substitutions import PathJoinSubstitution
from launch_ros.actions import ComposableNodeContainer, LifecycleNode, Node, PushRosNamespace, SetParameter
from launch_ros.descriptions import ComposableNode
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare
URDF = '<robot name="r"><link name="base"/></robot>'

def generate_launch_description():
    talker = Node(package="demo_nodes_py", executable="talker", name="talker", namespace="a",
                  parameters=[{"rate": 1.0, "names": ["a", "b"]}], remappings=[("chatter", "words")])
    publisher = Node(package="robot_state_publisher", executable="robot_state_publisher",
                     parameters=[{"robot_description": ParameterValue(URDF, value_type=str)}])
    share = FindPackageShare("turtlesim")
    return LaunchDescription([
        DeclareLaunchArgument("speed", default_value="0.5", description="m/s", choices=["0.5", "1.0"]),
        SetEnvironmentVariable("COLOR", "1"),
        SetLaunchConfiguration("who", "world"),
        LogInfo(msg=["speed ", LaunchConfiguration("speed"), EnvironmentVariable("HOME")]),
        GroupAction([PushRosNamespace("b"), SetParameter("use_sim_time", False), publisher]),
        ExecuteProcess(cmd=["echo", "hi"], output="screen", condition=IfCondition("true")),
        TimerAction(period=0.1, actions=[talker]),
        RegisterEventHandler(OnProcessStart(target_action=talker, on_start=[LogInfo(msg="up")])),
        RegisterEventHandler(OnProcessExit(target_action=publisher, on_exit=EmitEvent(event=Shutdown()))),
        LogInfo(msg=PythonExpression(["1 + ", LaunchConfiguration("speed")]), condition=UnlessCondition("0")),
        IncludeLaunchDescription(PythonLaunchDescriptionSource([share, "/launch/multisim.launch.py"]),
                                 launch_arguments={"speed": "1.0"}.items()),
        OpaqueFunction(function=lambda context: [LogInfo(msg=LaunchConfiguration("who").perform(context))]),
        ComposableNodeContainer(name="c", namespace="", package="rclcpp_components",
            executable="component_container",
            composable_node_descriptions=[ComposableNode(package="p", plugin="p::P", name="p")]),
        LifecycleNode(package="nav2_map_server", executable="map_server", name="m", namespace=""),
        LogInfo(msg=PathJoinSubstitution([share, "launch"])),
    ])
"""
XML = """\
<launch>
  <arg name="speed" default="0.5" description="m/s"/>
  <let name="who" value="world"/>
  <set_env name="COLOR" value="1"/>
  <log message="speed $(var speed) $(env HOME) $(find-pkg-share turtlesim)"/>
  <group if="$(eval '1 == 1')">
    <push_ros_namespace namespace="a"/>
    <set_parameter name="use_sim_time" value="false"/>
    <node pkg="demo_nodes_py" exec="talker" name="talker" output="screen">
      <param name="rate" value="1.0"/>
      <param name="names" value="a, b" value-sep=", "/>
      <remap from="chatter" to="words"/>
    </node>
  </group>
  <executable cmd="echo hi" output="screen"/>
  <timer period="0.1"><node pkg="demo_nodes_py" exec="listener"/></timer>
  <include file="$(find-pkg-share turtlesim)/launch/multisim.launch.py"><arg name="a" value="1"/></include>
  <node pkg="robot_state_publisher" exec="robot_state_publisher" unless="false">
    <param name="robot_description" type="str" value="&lt;robot name='r'>&lt;link name='base'/>&lt;/robot>"/>
  </node>
  <node_container pkg="rclcpp_components" exec="component_container" name="c" namespace="">
    <composable_node pkg="p" plugin="p::P" name="p"/>
  </node_container>
</launch>
"""
YAML = """\
launch:
- arg: {name: "speed", default: "0.5", description: "m/s"}
- let: {name: "who", value: "world"}
- set_env: {name: "COLOR", value: "1"}
- log: {message: "speed $(var speed) $(env HOME)"}
- group:
    if: "true"
    scoped: true
    children:
    - push_ros_namespace: {namespace: "a"}
    - node:
        pkg: "demo_nodes_py"
        exec: "talker"
        param:
        - {name: "rate", value: 1.0}
        - {from: "no_such.yaml"}
        remap: [{from: "chatter", to: "words"}]
- executable: {cmd: "echo hi", output: "screen"}
- timer: {period: 0.1, children: [{node: {pkg: "demo_nodes_py", exec: "listener"}}]}
- include: {file: "$(find-pkg-share turtlesim)/launch/multisim.launch.py", arg: [{name: "a", value: "1"}]}
"""
WORDS = (
    '""', '" "', '"x"', '"0"', '"-1"', '"nan"', '"$(var"', '"$(var nope)"', '"$(find-pkg-share nope)"',
    '"a: b"', '"[1, 2"', '"{a: 1}"', '"~"', '"/"', '"é"', '"true"', '"nav2_bringup"', '"echo"', '"base"',
)  # fmt: skip
PLAIN = ("None", "0", "-1", "1e308", "[]", "{}", "()", "True", "object()", "print", "lambda: 1", "...")
NAMES = (
    "LogInfo", "Node", "GroupAction", "TimerAction", "LaunchDescription", "talker", "share", "package",
    "name", "executable", "msg", "cmd", "parameters", "condition", "nope", "IfCondition", "Shutdown",
    "node", "param", "let", "arg", "value", "if", "exec", "launch",
)  # fmt: skip
_STRING, _NUMBER, _NAME = r'"[^"\n]*"', r"(?<![\w\"])\d+\.?\d*(?![\w\"])", r"\b[A-Za-z_]\w*\b"


def mutated(chance: random.Random, text: str) -> str:
    """Return a launch file with a few strings, numbers, names, lines or characters changed."""
    for _ in range(chance.choice((1, 1, 1, 2, 3, 6))):
        kind = chance.randrange(6)
        if kind == 0:
            text = _replaced(chance, text, _STRING, WORDS)
        elif kind == 1:
            text = _replaced(chance, text, rf"{_STRING}|{_NUMBER}", PLAIN)
        elif kind == 2:
            text = _replaced(chance, text, _NAME, NAMES)
        elif kind == 3:
            lines = text.splitlines(keepends=True)
            del lines[chance.randrange(len(lines))]
            text = "".join(lines) or "\n"
        elif kind == 4:
            lines = text.splitlines(keepends=True)
            lines.insert(chance.randrange(len(lines)), chance.choice(lines))
            text = "".join(lines)
        else:
            place = chance.randrange(len(text))
            text = (
                text[:place] + chance.choice("<>\"'()[]{}:,&$\t\0é1 ") + text[place + chance.randrange(3) :]
            )
    return text


def _replaced(chance: random.Random, text: str, pattern: str, others: tuple[str, ...]) -> str:
    found = list(re.finditer(pattern, text))
    if not found:
        return text
    one = chance.choice(found)
    return text[: one.start()] + chance.choice(others) + text[one.end() :]


def run_mutations(seed: int, count: int, folder: Path) -> Iterator[str]:
    """Run mutated launch files; yield exceptions that escape, and tracebacks with lines of the kit."""
    chance = random.Random(seed)
    for number in range(count):
        suffix, text = chance.choice(((".py", PYTHON), (".xml", XML), (".yaml", YAML)))
        file = folder / f"fuzz.launch{suffix}"
        file.write_text(mutated(chance, text), encoding="utf-8")
        written = io.StringIO()
        try:
            with redirect_stdout(written), redirect_stderr(written):
                recorded(file, seconds=0.3)
        except CourseError:
            # The command prints it in one line.
            pass
        except Exception as error:
            yield f"{suffix} {number}: {type(error).__name__}: {error}\n{file.read_text(encoding='utf-8')}"
        if f'File "{KIT}' in written.getvalue():
            yield f"{suffix} {number}: {written.getvalue()[-2000:]}\n{file.read_text(encoding='utf-8')}"
