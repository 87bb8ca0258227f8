"""Mistakes in launch files: the output states the line and the correction, without frames of the kit."""

from collections.abc import Callable
from pathlib import Path

import pytest

from course_lib.ros.student_code import KIT
from tests.ros.launch.run import recorded

Write = Callable[..., Path]
# An action, and strings that the output must contain in addition to the file's name.
MISTAKES = [
    ("ExecuteProcess(cmd='ros2 topic list')", "expected a list of words: cmd=['ros2', 'topic', 'list']"),
    ("Node(**TALKER, arguments='--verbose')", "expected a list: arguments=['--verbose']"),
    ("Node(**TALKER, condition='true')", "no attribute 'evaluate': condition takes a condition such as"),
    ("Node(**TALKER, condition=LaunchConfiguration('x'))", "'LaunchConfiguration' object has no attribute"),
    (
        "Node(**TALKER, parameters=[{'rate': None}])",
        "Unexpected type for parameter value None: parameter rate",
    ),
    ("Node(**TALKER, parameters=[{'a': {'b': None}}])", "parameter b takes a bool, number, string"),
    (
        "IncludeLaunchDescription('a.launch.py', launch_arguments={'a': 'b'})",
        "expected pairs: launch_arguments={'a': 'b'}.items()",
    ),
    ("GroupAction(Node(**TALKER))", "GroupAction takes a list, as in GroupAction([Node(…)])"),
    (
        "LaunchDescription(Node(**TALKER))",
        "LaunchDescription takes a list, as in LaunchDescription([Node(…)])",
    ),
    ("LaunchDescription(Node(**TALKER), Node(**TALKER))", "takes one list: put all actions into it"),
    ("TimerAction(period=1.0, actions=Node(**TALKER))", "TimerAction takes a list"),
    ("Node(**TALKER, name=LaunchConfiguration('x') + '_node')", "hint: a substitution has no value while"),
    ("Node(**TALKER, name='robot_' + LaunchConfiguration('x'))", "hint: a substitution has no value while"),
    ("LogInfo(msg=open(LaunchConfiguration('x')).read())", "with .perform(context)"),
    ("LogInfo(msg=PythonExpression(['gui == 1']))", "NameError: name 'gui' is not defined, in `gui == 1` ("),
    ("SetEnvironmentVariable('A')", "hint: SetEnvironmentVariable(…) also needs 'value'."),
    ("PushRosNamespce('a')", "hint: did you mean `PushRosNamespace`?"),
]


@pytest.mark.parametrize(("action", "expected"), MISTAKES, ids=[action for action, _ in MISTAKES])
def test_mistake_in_an_action_is_reported_with_its_line(
    action: str, expected: str, launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    assert recorded(launch_file(action))[1] == 1
    output = "".join(capsys.readouterr())
    assert expected in output
    assert "robot.launch.py" in output
    assert action in output
    assert KIT not in output


def test_substitution_as_a_reaction_is_reported_when_the_process_exits(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    recorded(launch_file("ExecuteProcess(cmd=['true'], on_exit=LaunchConfiguration('x'))"))
    text = (
        "'LaunchConfiguration' object has no attribute 'visit': pass an action such as Shutdown(), or a list"
    )
    assert text in "".join(capsys.readouterr())


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("def generate_launch_description(context): pass", "Write: def generate_launch_description():"),
        ("def generate_launch_description(): return [1]", "returned a list; end it with: return"),
        ("def generate_launch_description(): return None", "returned None; end it with: return"),
        (
            "from launch import LaunchDescription\n"
            "def generate_launch_description(): return LaunchDescription().add_action(None)",
            "returned None; end it with a return of the LaunchDescription; add_action() itself returns None",
        ),
        ("def generate_test_description(): pass", "It is a test for launch_testing"),
    ],
)
def test_wrong_generate_launch_description_is_reported_with_its_file(
    text: str, expected: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "robot.launch.py"
    file.write_text(text)
    assert recorded(file)[1] == 1
    output = "".join(capsys.readouterr())
    assert expected in output
    assert str(file) in output


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("from launch_ros import Node", "`from launch_ros.actions import Node`"),
        ("from launch import IfCondition", "`from launch.conditions import IfCondition`"),
    ],
)
def test_hint_suggests_the_right_module_for_a_wrong_launch_import(
    line: str, expected: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "robot.launch.py"
    file.write_text(f"{line}\ndef generate_launch_description(): pass")
    assert recorded(file)[1] == 1
    assert expected in "".join(capsys.readouterr())


def test_file_of_a_missing_package_that_the_launch_file_reads_is_reported_with_the_package(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "robot.launch.py"
    file.write_text(
        "from ament_index_python.packages import get_package_share_path\n"
        "def generate_launch_description():\n"
        "    text = (get_package_share_path('gazebo_ros') / 'a.urdf').read_text()\n"
    )
    assert recorded(file)[1] == 1
    printed = capsys.readouterr().out
    assert (
        "No such file or directory: '/opt/ros/jazzy/share/gazebo_ros/a.urdf': package 'gazebo_ros'" in printed
    )
    assert "robot.launch.py, line 3" in printed


def test_missing_parameter_file_is_reported_and_the_node_starts(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    recording, code = recorded(launch_file("Node(**TALKER, parameters=['nowhere.yaml'])"))
    assert code == 0
    assert "/chatter" in [topic.name for topic in recording.topics()]
    line = "[WARNING] [launch_ros.actions.node]: Parameter file path is not a file: nowhere.yaml"
    assert line in capsys.readouterr().out


def test_string_with_a_substitution_object_is_reported(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    recorded(launch_file("Node(**TALKER, name=f\"{LaunchConfiguration('x', default='a')}_node\")"))
    assert "contains a LaunchConfiguration that has no value yet" in capsys.readouterr().out


def test_substitutions_in_a_parameter_file_of_a_python_launch_file_are_performed(
    robot: Path, launch_file: Write
) -> None:
    file = robot / "config" / "words.yaml"
    file.write_text("/**: {ros__parameters: {word: $(find-pkg-share my_robot)}}")
    imported = "__import__('launch_ros.parameter_descriptions').parameter_descriptions.ParameterFile"
    recording, code = recorded(
        launch_file(f"Node(**TALKER, parameters=[{imported}({str(file)!r}, allow_substs=True)])")
    )
    assert code == 0
    assert str(robot) in next(recording.messages("/chatter"))[1].data  # type: ignore[attr-defined]


def test_missing_layout_of_rviz_does_not_end_the_launch(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    rviz = "Node(package='rviz2', executable='rviz2', arguments=['-d', '/nowhere/a.rviz'])"
    assert recorded(launch_file("Node(**TALKER)", rviz))[1] == 0
    assert "[ERROR] [rviz2]: There is no layout /nowhere/a.rviz." in capsys.readouterr().out


def test_ros_1_namespace_of_a_group_is_reported_with_the_element_of_ros_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "robot.launch.xml"
    file.write_text('<launch><group ns="a"/></launch>')
    assert recorded(file)[1] == 1
    assert '<push-ros-namespace namespace="…"/>' in capsys.readouterr().out


def test_manifest_that_is_a_broken_link_is_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    package = tmp_path / "src" / "arm"
    package.mkdir(parents=True)
    (package / "package.xml").symlink_to(tmp_path / "gone.xml")
    file = tmp_path / "a.launch.xml"
    file.write_text('<launch><log message="$(find-pkg-share arm)"/></launch>')
    monkeypatch.chdir(tmp_path)
    recorded(file)
    assert f"package.xml is a link to {tmp_path / 'gone.xml'}: No such file" in capsys.readouterr().out
