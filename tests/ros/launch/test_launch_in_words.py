"""Launch files in XML and YAML."""

from collections import Counter
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from course_lib.ros.messages import deserialize, message_class
from course_lib.ros.programs.launch_program import arguments_of
from tests.ros.launch.run import recorded

Write = Callable[..., Path]


@pytest.fixture
def words(robot: Path) -> Write:
    """Write a launch file of my_robot in XML or YAML, by its name."""

    def write(text: str, name: str = "robot.launch.xml") -> Path:
        file = robot / "launch" / name
        file.write_text(text, encoding="utf-8")
        return file

    return write


def count_published(file: Path, *args: str) -> Counter[str]:
    """Count the (topic, string) pairs that a launch publishes within a second."""
    recording, code = recorded(file, *args)
    assert code == 0
    cls = message_class("std_msgs/msg/String")
    samples = [s for s in recording.samples if s.type_name == "std_msgs/msg/String"]
    messages: list[Any] = [deserialize(s.cdr, cls) for s in samples]
    return Counter(f"{s.topic} {m.data}" for s, m in zip(samples, messages, strict=True))


TALKER = '<node pkg="my_robot" exec="talker"'


@pytest.mark.parametrize(
    ("inner", "expected"),
    [
        (f"{TALKER}/>", {"/chatter 'hi' --ros-args": 1}),
        (f'{TALKER}><remap from="chatter" to="/words"/></node>', {"/words 'hi' --ros-args": 1}),
        (f'{TALKER} namespace="a" args="loud"/>', {"/a/chatter 'hi' loud": 1}),
        (f'{TALKER}><param name="rate" value="2.0"/></node>', {"/chatter 'hi' --ros-args": 2}),
        (f'{TALKER}><param name="word" value="5" type="str"/></node>', {"/chatter '5' --ros-args": 1}),
        (f'{TALKER}><param name="word" value="a b"/></node>', {"/chatter 'a b' --ros-args": 1}),
        ('<let name="w" value="yes it is"/>'
         f'{TALKER}><param name="word" value="$(var w)!" type="str"/></node>',
         {"/chatter 'yes it is!' --ros-args": 1}),
        (f'{TALKER} if="false"/>{TALKER} unless="$(eval \'1 + 1 == 2\')"/>', {}),
        (f'<group><push_ros_namespace namespace="a"/><set_remap from="chatter" to="c"/>{TALKER}/></group>'
         f"{TALKER}/>", {"/a/c 'hi' --ros-args": 1, "/chatter 'hi' --ros-args": 1}),
        (f'<group scoped="false"><push-ros-namespace namespace="a"/></group>{TALKER}/>',
         {"/a/chatter 'hi' --ros-args": 1}),
        (f'<set_parameter name="word" value="x"/>{TALKER}/>', {"/chatter 'x' --ros-args": 1}),
        (f'<timer period="0.5">{TALKER}><param name="rate" value="2.5"/></node></timer>',
         {"/chatter 'hi' --ros-args": 1}),
        ('<executable cmd="ros2 run my_robot talker loud"/>', {"/chatter 'hi' loud": 1}),
        (f'<set_env name="ROBOT" value="r2"/>{TALKER}><param name="word" value="$(env ROBOT)"/></node>',
         {"/chatter 'r2' --ros-args": 1}),
        (f'<group><set_env name="ROBOT" value="r2"/></group>{TALKER}>'
         '<param name="word" value="$(env ROBOT none)"/></node>', {"/chatter 'none' --ros-args": 1}),
    ],
)  # fmt: skip
def test_nodes_of_an_xml_launch_file_run_as_described(
    words: Write, inner: str, expected: dict[str, int]
) -> None:
    assert count_published(words(f"<launch>{inner}</launch>")) == expected


def test_parameters_are_read_from_a_file_with_substitutions_and_from_nested_elements(
    words: Write, robot: Path
) -> None:
    (robot / "config" / "p.yaml").write_text("talker:\n  ros__parameters: {rate: 4.0, word: '$(var w)'}\n")
    source = "$(find-pkg-share my_robot)/config/p.yaml"
    file = words(
        f'<launch><arg name="w" default="file"/>{TALKER}><param from="{source}" allow_substs="true"/></node>'
        f'{TALKER} name="n"><param name="deep"><param name="er" value="1"/></param></node></launch>'
    )
    assert count_published(file) == {"/chatter 'file' --ros-args": 4, "/chatter 'hi' --ros-args": 1}


def test_nodes_of_a_yaml_launch_file_run_as_described(words: Write) -> None:
    file = words(
        """
launch:
  - arg: {name: word, default: "hey", description: To say, choice: [{value: hey}, {value: ho}]}
  - group:
      - push_ros_namespace: {namespace: a}
      - node:
          pkg: my_robot
          exec: talker
          param: [{name: word, value: $(var word)}, {name: rate, value: 2.0}]
          remap:
            - {from: chatter, to: c}
  - group:
      if: "false"
      children:
        - node: {pkg: my_robot, exec: talker}
""",
        "robot.launch.yaml",
    )
    assert count_published(file, "word:=ho") == {"/a/c 'ho' --ros-args": 2}
    assert recorded(file, "word:=no")[1] == 1
    assert arguments_of(file).splitlines()[2:] == [
        "    'word':",
        "        To say. Valid choices are: ['hey', 'ho']",
        "        (default: 'hey')",
    ]


def test_python_xml_and_yaml_launch_files_include_each_other(words: Write, launch_file: Write) -> None:
    included = '<include file="$(dirname)/inner.launch.{}"><arg name="word" value="{}"/></include>'
    words(f'<launch><arg name="word"/>{TALKER}><param name="word" value="$(var word)"/></node></launch>',
          "inner.launch.xml")  # fmt: skip
    words("launch: [include: {file: $(dirname)/inner.launch.xml, arg: [{name: word, value: $(var word) y}]}]",
          "inner.launch.yaml")  # fmt: skip
    launch_file(
        "DeclareLaunchArgument('word')",
        "IncludeLaunchDescription(AnyLaunchDescriptionSource([ThisLaunchFileDir(), '/inner.launch.yaml']))",
        "IncludeLaunchDescription(XMLLaunchDescriptionSource([ThisLaunchFileDir(), '/inner.launch.xml']))",
        "IncludeLaunchDescription([ThisLaunchFileDir(), '/inner.launch.xml'])",
        name="inner.launch.py",
    )
    outer = words(f"<launch>{included.format('py', 'from xml')}</launch>")
    assert count_published(outer) == {"/chatter 'from xml y' --ros-args": 3}


def test_deprecated_attribute_of_a_launch_file_logs_a_warning(
    words: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    file = words('<launch deprecated="use the other"><log message="hi $(filename)"/></launch>')
    assert recorded(file)[1] == 0
    assert capsys.readouterr().out.splitlines()[1:] == [
        f"[WARNING] [launch]: launch file [{file}] is deprecated: use the other",
        f"[INFO] [launch.user]: hi {file}",
    ]


LAUGHS = "<!DOCTYPE launch [<!ENTITY a 'ha'><!ENTITY b '&a;&a;'>]><launch><log message='&b;'/></launch>"
ALIASES = "a: &a [x, x]\n" + "".join(f"{b}: &{b} [*{a}, *{a}, *{a}]\n" for a, b in pairwise("abcdefghijkl"))
DEEP = f"<launch>{'<group>' * 60}{'</group>' * 60}</launch>"


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("x.launch.xml", "<launch>\n <node>\n</launch>", "line 3: not XML: mismatched tag."),
        ("x.launch.xml", "", "line 1: not XML: no element found."),
        ("x.launch.xml", "<robot/>", "line 1: the root is 'robot', expected 'launch'."),
        ("x.launch.xml", "<launch>\n\n<nod pkg='a'/></launch>",
         "line 3: <nod>: there is no such element. Did you mean node?"),
        ("x.launch.xml", f"<launch>\n{TALKER} nmae='a'/></launch>",
         "line 2: <node>: unexpected attribute 'nmae'. Did you mean name? It has: "),
        ("x.launch.xml", "<launch>\n<arg name='a' doc='b'/></launch>",
         "line 2: <arg>: unexpected attribute 'doc'. This is a file of ROS 1: in ROS 2 it is description."),
        ("x.launch.xml", f"<launch>\n{TALKER}>\n<arg name='a'/></node></launch>",
         "line 3: <arg>: it is not expected in <node>."),
        ("x.launch.xml", "<launch>\n<node pkg='a' type='b'/></launch>",
         "line 2: <node>: it needs 'exec'. This is a file of ROS 1: in ROS 2 the executable is exec"),
        ("x.launch.xml", "<launch>\n<node package='a' executable='b'/></launch>",
         "line 2: <node>: it needs 'exec'. Here it is exec, and not executable as in Python"),
        ("x.launch.yaml", "launch:\n- node:\n    package: a\n    exec: b\n",
         "Here it is pkg, and not package as in Python"),
        ("x.launch.xml", f"<launch>\n{TALKER}>\n\n<param name='a'/></node></launch>",
         "line 4: <param>: it needs either 'value' or param elements in it."),
        ("x.launch.xml", f"<launch>{TALKER}><param name='a' value='x' type='real'/></node></launch>",
         "type is 'real', expected one of str, bool, float, int, list_of_str"),
        ("x.launch.xml", f"<launch>{TALKER} respawn_delay='soon'/></launch>",
         "<node>: respawn_delay is 'soon', expected a number with a point, like 2.0."),
        ("x.launch.xml", "<launch><log message='$(var'/></launch>",
         "<log>: '$(var', character 6: expected ')'"),
        ("x.launch.xml", "<launch><log message='$(find my_robot)/x'/></launch>",
         "there is no substitution 'find'. In ROS 2 write $(find-pkg-share …)."),
        ("x.launch.xml", "<launch><log message='$(eval 1 + 1)'/></launch>",
         "$(eval 1 + 1): eval has 3 arguments, expected 1 to 2. Arguments with spaces stand in quotes."),
        ("x.launch.xml", f"<launch>{TALKER} if='1' unless='0'/></launch>",
         "if and unless conditions can't be used simultaneously."),
        ("x.launch.xml", LAUGHS, "the file declares the entity 'a', which launch files do not need."),
        ("x.launch.xml", DEEP, "more than 50 elements are nested."),
        ("x.launch.yaml", "launch:\n  - node: {pkg: a\n", "line 3: not YAML: "),
        ("x.launch.yaml", "launch:\n- log:\n    message: \0\n",
         "line 3: not YAML: unacceptable character #x0000: special characters are not allowed."),
        ("x.launch.yaml", "", "line 1: expected one key, `launch:`, with a list of elements."),
        ("x.launch.yaml", "launch:\n- log: {message: hi}\n- nod:\n    pkg: a\n",
         "line 3: <nod>: there is no such element. Did you mean node?"),
        ("x.launch.yaml", "launch:\n- log: {message: 5}\n",
         "<log>: message is 5, expected text; put quotes around it."),
        ("x.launch.yaml", "launch:\n- timer: {period: 5, children: []}\n",
         "<timer>: period is 5, expected a number with a point, like 2.0."),
        ("x.launch.yaml", "launch:\n- node\n", "node in <launch>: expected one element, as in `- node: {"),
        ("x.launch.yaml", "launch:\n- node: {exec: a, param: [b]}\n",
         "param is ['b'], expected a list of mappings."),
        ("x.launch.yaml", f"launch:\n  {ALIASES.replace(chr(10), chr(10) + '  ')}",
         "more than 50000 values, with all aliases followed."),
        ("x.launch.yaml", "launch: &a\n- group: *a\n", "nested elements, with all aliases followed."),
    ],
)  # fmt: skip
def test_launch_file_error_is_one_line_with_file_line_number_and_expected_value(
    words: Write, name: str, text: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = words(text, name)
    assert recorded(file)[1] == 1
    [line] = [line for line in capsys.readouterr().out.splitlines() if "[ERROR]" in line]
    assert f"{file}, line " in line
    assert message in line
