import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros.launch_program import arguments_of
from course_lib.ros.messages import deserialize, message_class
from course_lib.ros.process import Program
from tests.ros.launch.run import recorded

Write = Callable[..., Path]


def heard(recording: Recording) -> Counter[str]:
    """Count the texts, as topic and what it says."""
    cls = message_class("std_msgs/msg/String")
    samples = [s for s in recording.samples if s.type_name == "std_msgs/msg/String"]
    messages: list[Any] = [deserialize(s.cdr, cls) for s in samples]
    return Counter(f"{s.topic} {m.data}" for s, m in zip(samples, messages, strict=True))


@pytest.mark.parametrize(
    ("actions", "expected"),
    [
        (["Node(**TALKER)"], {"/chatter 'hi' --ros-args": 1}),
        (["Node(**TALKER, remappings=[('chatter', '/words')])"], {"/words 'hi' --ros-args": 1}),
        (["Node(**TALKER, namespace='a')"], {"/a/chatter 'hi' --ros-args": 1}),
        (["Node(**TALKER, arguments=['loud'])"], {"/chatter 'hi' loud": 1}),
        (["Node(**TALKER, parameters=[{'word': 'true', 'rate': 2.0}])"], {"/chatter 'true' --ros-args": 2}),
        (["Node(**TALKER, parameters=[{'word': ParameterValue(['1'], value_type=str)}])"],
         {"/chatter '1' --ros-args": 1}),
        (["Node(**TALKER, parameters=[{'word': 'a: \"b\" ä'}])"], {"/chatter 'a: \"b\" ä' --ros-args": 1}),
        (["GroupAction([PushRosNamespace('a'), PushRosNamespace('b'), Node(**TALKER)])", "Node(**TALKER)"],
         {"/a/b/chatter 'hi' --ros-args": 1, "/chatter 'hi' --ros-args": 1}),
        (["PushRosNamespace('a')", "Node(**TALKER, namespace='/b')"], {"/b/chatter 'hi' --ros-args": 1}),
        (["GroupAction([SetParameter('word', 'x'), SetRemap('chatter', 'c'), Node(**TALKER)])",
          "Node(**TALKER)"], {"/c 'x' --ros-args": 1, "/chatter 'hi' --ros-args": 1}),
        (["SetParameter('word', 'x')", "Node(**TALKER, parameters=[{'word': 'y'}])"],
         {"/chatter 'y' --ros-args": 1}),
        (["Node(**TALKER, condition=IfCondition('False'))", "Node(**TALKER, condition=UnlessCondition('1'))"],
         {}),
        (["TimerAction(period=0.5, actions=[Node(**TALKER, parameters=[{'rate': 2.5}])])"],
         {"/chatter 'hi' --ros-args": 1}),
        (["OpaqueFunction(function=lambda context: [Node(**TALKER)])"], {"/chatter 'hi' --ros-args": 1}),
    ],
)  # fmt: skip
def test_nodes_run_as_the_file_describes_them(
    launch_file: Write, actions: list[str], expected: dict[str, int]
) -> None:
    recording, code = recorded(launch_file(*actions))
    assert code == 0
    assert heard(recording) == expected


def test_parameters_come_from_the_package_s_file_and_later_ones_count_more(
    launch_file: Write, robot: Path
) -> None:
    (robot / "config" / "p.yaml").write_text("talker:\n  ros__parameters: {rate: 4.0, word: file}\n")
    path = "PathJoinSubstitution([FindPackageShare('my_robot'), 'config', 'p.yaml'])"
    recording, _ = recorded(launch_file(f"Node(**TALKER, parameters=[{path}, {{'word': 'dict'}}])"))
    assert heard(recording) == {"/chatter 'dict' --ros-args": 4}


def test_arguments_set_configurations(launch_file: Write) -> None:
    file = launch_file(
        "DeclareLaunchArgument('word', default_value='hi', choices=['hi', 'ho'], description='To say')",
        "Node(**TALKER, parameters=[{'word': LaunchConfiguration('word')}])",
    )
    assert heard(recorded(file, "word:=ho")[0]) == {"/chatter 'ho' --ros-args": 1}
    assert recorded(file, "word:=he")[1] == 1
    assert arguments_of(file).splitlines()[2:] == [
        "    'word':",
        "        To say. Valid choices are: ['hi', 'ho']",
        "        (default: 'hi')",
    ]


def test_what_is_for_ros_goes_to_all_nodes(launch_file: Write) -> None:
    file = launch_file("DeclareLaunchArgument('word')", "Node(**TALKER, namespace='a')", "Node(**TALKER)")
    recording, code = recorded(file, "--ros-args", "-p", "rate:=4.0", "--", "word:=x")
    assert code == 0
    assert heard(recording) == {"/a/chatter 'hi' --ros-args": 4, "/chatter 'hi' --ros-args": 4}


def test_included_files_get_arguments_and_know_their_folder(launch_file: Write) -> None:
    inner = launch_file(
        "DeclareLaunchArgument('word')",
        "Node(**TALKER, parameters=[{'word': [LaunchConfiguration('word'), ThisLaunchFileDir()]}])",
        name="inner.launch.py",
    )
    source = "PythonLaunchDescriptionSource([ThisLaunchFileDir(), '/inner.launch.py'])"
    outer = launch_file(f"IncludeLaunchDescription({source}, launch_arguments={{'word': 'in:'}}.items())")
    assert heard(recorded(outer)[0]) == {f"/chatter 'in:{inner.parent}' --ros-args": 1}
    assert recorded(inner)[1] == 1


def test_handlers_take_starts_ends_and_the_shutdown(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    file = launch_file(
        "(once := Node(package='my_robot', executable='once'))",
        "Node(**TALKER)",
        "RegisterEventHandler(OnProcessStart(target_action=once, on_start=LogInfo(msg='started')))",
        "RegisterEventHandler(OnProcessExit(target_action=once, on_exit=["
        "LogInfo(msg='ended'), EmitEvent(event=ShutdownEvent(reason='done'))]))",
        "RegisterEventHandler(OnShutdown(on_shutdown=lambda event, context: [LogInfo(msg=event.reason)]))",
        "TimerAction(period=0.5, actions=[LogInfo(msg='never')])",
    )
    recording, code = recorded(file)
    lines = [line for line in capsys.readouterr().out.splitlines() if "launch.user" in line]
    assert lines == [f"[INFO] [launch.user]: {word}" for word in ("started", "ended", "done")]
    assert code == 0
    assert heard(recording) == {"/chatter 'hi' --ros-args": 1}  # the talker was ended before its first tick


def test_ros2_is_a_process_too(launch_file: Write) -> None:
    words = "['ros2', 'topic', 'pub', '--once', '-w', '0', '/words', 'std_msgs/msg/String', '{data: hey}']"
    line = "topic pub --once -w 0 /words std_msgs/msg/String '{data: ho}'"
    file = launch_file(
        f"(first := ExecuteProcess(cmd={words}, output='screen'))",
        "RegisterEventHandler(OnProcessExit(target_action=first, on_exit="
        f"ExecuteProcess(cmd=[[FindExecutable(name='ros2'), \" {line}\"]], shell=True)))",
    )
    recording, code = recorded(file, seconds=3.0)
    assert code == 0
    assert heard(recording) == {"/words hey": 1, "/words ho": 1}


def test_a_process_that_dies_is_named_and_the_others_go_on(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    recording, code = recorded(launch_file("Node(package='my_robot', executable='fail')", "Node(**TALKER)"))
    shown = capsys.readouterr()
    assert code == 1
    assert heard(recording) == {"/chatter 'hi' --ros-args": 1}
    assert "[fail-1] ValueError: no laser\n" in shown.err
    assert "[ERROR] [fail-1]: process has died [pid 1, exit code 1, cmd 'fail-1 " in shown.out


@pytest.mark.parametrize(
    ("action", "said"),
    [
        ("Node(package='nowhere', executable='x')", "package 'nowhere' not found"),
        ("LogInfo(msg=FindPackageShare('nowhere'))", "course export FILE --package nowhere"),
        ("Node(package='my_robot', executable='talkr')", "Did you mean talker?"),
        ("Node(package='rviz2', executable='rviz')", "which has: rviz2"),
        ("LogInfo(msg=LaunchConfiguration('nope'))", "launch configuration 'nope' does not exist"),
        ("LogInfo(msg='x', condition=IfCondition('maybe'))", "given 'maybe', expected one of"),
        ("ExecuteProcess(cmd=['ls', '-l'])", "`ls -l` would run outside robot time"),
        ("DeclareLaunchArgument('a')", 'Required launch argument "a" was not provided.'),
        ("IncludeLaunchDescription(PythonLaunchDescriptionSource('other.launch.xml'))", "not a Python file"),
    ],
)
def test_what_is_wrong_is_one_line_that_says_what_would_be_right(
    launch_file: Write, capsys: pytest.CaptureFixture[str], action: str, said: str
) -> None:
    _, code = recorded(launch_file(action))
    opening, *lines = capsys.readouterr().out.splitlines()
    assert code == 1
    assert opening == "[INFO] [launch]: Default logging verbosity is set to INFO"
    assert len(lines) == 1
    assert said in lines[0]


def test_a_mistake_in_the_file_is_a_traceback(launch_file: Write, capsys: pytest.CaptureFixture[str]) -> None:
    _, code = recorded(launch_file("Node(**TALKER, paramters=[])"))
    assert code == 1
    assert (
        "TypeError: Node.__init__() got an unexpected keyword argument 'paramters'" in capsys.readouterr().err
    )


def test_a_file_that_returns_no_description_is_told_how_to_end(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "empty.launch.py"
    file.write_text("def generate_launch_description():\n    pass\n")
    assert recorded(file)[1] == 1
    assert "returned None; end it with: return LaunchDescription" in capsys.readouterr().out


def test_two_runs_of_a_launch_are_alike(launch_file: Write) -> None:
    file = launch_file("Node(**TALKER, name='a')", "Node(**TALKER, name='b', parameters=[{'rate': 20.0}])")
    assert recorded(file)[0].digest() == recorded(file)[0].digest()


def test_a_changed_package_is_read_again(launch_file: Write, robot: Path) -> None:
    file = launch_file("Node(**TALKER)")
    recorded(file)
    source = robot / "my_robot" / "talker.py"
    source.write_text(source.read_text().replace('"hi"', '"changed"'))
    assert heard(recorded(file)[0]) == {"/chatter 'changed' --ros-args": 1}


def test_arguments_of_a_program_that_is_no_launch_file_are_an_error(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text("print(1)")
    with pytest.raises(CourseError, match="generate_launch_description"):
        arguments_of(tmp_path / "program.py")


def test_a_file_with_the_name_of_a_launch_file_is_one_even_if_it_describes_nothing(tmp_path: Path) -> None:
    file = tmp_path / "empty.launch.py"
    file.write_text("import launch\n")
    assert Program(file, []).is_launch_file


WORDY = """
import sys, time
def main():
    for word in ("one", "two"):
        print(word, end=" ")
        time.sleep(0.1)
        print("three\\nfour")
    print("no line end", end="")
    print("to stderr", file=sys.stderr)
"""


def test_each_line_of_a_process_stands_behind_its_name(
    launch_file: Write, robot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (robot / "my_robot" / "talker.py").write_text(WORDY)
    node = "Node(package='my_robot', executable='talker')"
    before = sys.stdout
    assert recorded(launch_file(node, node))[1] == 0
    assert sys.stdout is before
    shown = capsys.readouterr()
    lines = [line for line in shown.out.splitlines() if line.startswith("[talker-1]")]
    assert [line.removeprefix("[talker-1] ") for line in lines] == [
        *("one three", "four", "two three", "four", "no line end")
    ]
    assert shown.err == "[talker-1] to stderr\n[talker-2] to stderr\n"
    others = {line.split("]")[0] for line in shown.out.splitlines()}
    assert others == {"[INFO", "[talker-1", "[talker-2"}


def test_a_launched_process_gets_the_words_of_its_node_and_no_more(
    launch_file: Write, robot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (robot / "my_robot" / "talker.py").write_text("import sys\ndef main():\n    print(sys.argv[1:])\n")
    assert recorded(launch_file("Node(package='my_robot', executable='talker', arguments=['fast'])"))[1] == 0
    assert "[talker-1] ['fast', '--ros-args']\n" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("bad", "said"),
    [
        ("LogInfo(msg=LaunchConfiguration('nope'))", "'nope' does not exist"),
        ("'no action'", "AttributeError"),
    ],
)
def test_a_mistake_in_a_timer_ends_the_launch_and_its_processes(
    launch_file: Write, bad: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = launch_file("Node(**TALKER)", f"TimerAction(period=0.5, actions=[{bad}])")
    recording, code = recorded(file, seconds=None)
    assert (len(heard(recording)), code) == (0, 1)
    captured = capsys.readouterr()
    assert said in captured.out + captured.err
