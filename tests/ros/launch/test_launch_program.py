import re
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from launch import LaunchDescription
from launch.launch_description_sources import load_python_launch_file_as_module

from course_lib.errors import CourseError
from course_lib.recording import Recording
from course_lib.ros.messages import deserialize, message_class
from course_lib.ros.programs.launch_program import arguments_of
from course_lib.ros.programs.process import Program
from tests.ros.launch.run import recorded

Write = Callable[..., Path]


def count_published(recording: Recording) -> Counter[str]:
    """Count the published (topic, string) pairs."""
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
def test_nodes_run_as_described_in_the_launch_file(
    launch_file: Write, actions: list[str], expected: dict[str, int]
) -> None:
    recording, code = recorded(launch_file(*actions))
    assert code == 0
    assert count_published(recording) == expected


def test_later_parameters_override_the_parameter_file_of_the_package(launch_file: Write, robot: Path) -> None:
    (robot / "config" / "p.yaml").write_text("talker:\n  ros__parameters: {rate: 4.0, word: file}\n")
    path = "PathJoinSubstitution([FindPackageShare('my_robot'), 'config', 'p.yaml'])"
    recording, _ = recorded(launch_file(f"Node(**TALKER, parameters=[{path}, {{'word': 'dict'}}])"))
    assert count_published(recording) == {"/chatter 'dict' --ros-args": 4}


def test_launch_arguments_set_configurations(launch_file: Write) -> None:
    file = launch_file(
        "DeclareLaunchArgument('word', default_value='hi', choices=['hi', 'ho'], description='To say')",
        "Node(**TALKER, parameters=[{'word': LaunchConfiguration('word')}])",
    )
    assert count_published(recorded(file, "word:=ho")[0]) == {"/chatter 'ho' --ros-args": 1}
    assert recorded(file, "word:=he")[1] == 1
    assert arguments_of(file).splitlines()[2:] == [
        "    'word':",
        "        To say. Valid choices are: ['hi', 'ho']",
        "        (default: 'hi')",
    ]


def test_ros_args_of_a_launch_are_passed_to_all_nodes(launch_file: Write) -> None:
    file = launch_file("DeclareLaunchArgument('word')", "Node(**TALKER, namespace='a')", "Node(**TALKER)")
    recording, code = recorded(file, "--ros-args", "-p", "rate:=4.0", "--", "word:=x")
    assert code == 0
    assert count_published(recording) == {"/a/chatter 'hi' --ros-args": 4, "/chatter 'hi' --ros-args": 4}


def test_included_launch_file_gets_arguments_and_its_own_directory(launch_file: Write) -> None:
    inner = launch_file(
        "DeclareLaunchArgument('word')",
        "Node(**TALKER, parameters=[{'word': [LaunchConfiguration('word'), ThisLaunchFileDir()]}])",
        name="inner.launch.py",
    )
    source = "PythonLaunchDescriptionSource([ThisLaunchFileDir(), '/inner.launch.py'])"
    outer = launch_file(f"IncludeLaunchDescription({source}, launch_arguments={{'word': 'in:'}}.items())")
    assert count_published(recorded(outer)[0]) == {f"/chatter 'in:{inner.parent}' --ros-args": 1}
    assert recorded(inner)[1] == 1


def test_event_handlers_handle_process_starts_exits_and_shutdown(
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
    assert count_published(recording) == {
        "/chatter 'hi' --ros-args": 1
    }  # the talker was ended before its first tick


def test_ros2_command_runs_as_a_process(launch_file: Write) -> None:
    words = "['ros2', 'topic', 'pub', '--once', '-w', '0', '/words', 'std_msgs/msg/String', '{data: hey}']"
    line = "topic pub --once -w 0 /words std_msgs/msg/String '{data: ho}'"
    file = launch_file(
        f"(first := ExecuteProcess(cmd={words}, output='screen'))",
        "RegisterEventHandler(OnProcessExit(target_action=first, on_exit="
        f"ExecuteProcess(cmd=[[FindExecutable(name='ros2'), \" {line}\"]], shell=True)))",
    )
    recording, code = recorded(file, seconds=3.0)
    assert code == 0
    assert count_published(recording) == {"/words hey": 1, "/words ho": 1}


def test_failed_process_is_reported_and_the_others_continue(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    recording, code = recorded(launch_file("Node(package='my_robot', executable='fail')", "Node(**TALKER)"))
    captured = capsys.readouterr()
    assert code == 1
    assert count_published(recording) == {"/chatter 'hi' --ros-args": 1}
    assert "[fail-1] ValueError: no laser\n" in captured.err
    assert "[ERROR] [fail-1]: process has died [pid 1, exit code 1, cmd 'fail-1 " in captured.out


@pytest.mark.parametrize(
    ("action", "message"),
    [
        ("Node(package='nowhere', executable='x')", "package 'nowhere' not found"),
        ("Node(package='my_robot', executable='talkr')", "Did you mean talker?"),
        ("Node(package='rviz2', executable='rviz')", "which has: rviz2"),
        ("LogInfo(msg=LaunchConfiguration('nope'))", "launch configuration 'nope' does not exist"),
        ("LogInfo(msg='x', condition=IfCondition('maybe'))", "given 'maybe', expected one of"),
        ("ExecuteProcess(cmd=['ls', '-l'])", "`ls -l` would run outside robot time"),
        ("DeclareLaunchArgument('a')", 'Required launch argument "a" was not provided.'),
        ("IncludeLaunchDescription(PythonLaunchDescriptionSource('other.launch.xml'))", "not a Python file"),
    ],
)
def test_invalid_action_is_one_error_line_with_the_expected_value(
    launch_file: Write, capsys: pytest.CaptureFixture[str], action: str, message: str
) -> None:
    _, code = recorded(launch_file(action))
    opening, *lines = capsys.readouterr().out.splitlines()
    assert code == 1
    assert opening == "[INFO] [launch]: Default logging verbosity is set to INFO"
    assert len(lines) == 1
    assert message in lines[0]


GAZEBO = """
import os
from ament_index_python.packages import get_package_share_directory
simulator = get_package_share_directory("ros_gz_sim")
spawner = Node(package="ros_gz_sim", executable="create")
simulated = IncludeLaunchDescription(os.path.join(simulator, "launch", "gz_sim.launch.py"))
"""


@pytest.mark.parametrize(
    ("action", "reason"),
    [
        ("simulated", "package 'ros_gz_sim' not found: Gazebo is a simulator"),
        ("spawner", "package 'ros_gz_sim' not found: Gazebo is a simulator"),
        ("IncludeLaunchDescription([FindPackageShare('nowhere'), '/a.launch.xml'])",
         "package 'nowhere' not found"),
        ("IncludeLaunchDescription([ThisLaunchFileDir(), '/moveit.launch.py'])", "MoveIt's launch files"),
        ("Node(package='my_robot', executable='driver')", "'driver' of package 'my_robot' is a compiled"),
        ("Node(package='rplidar_ros', executable='rplidar_node')", "a driver needs its device"),
        ("LifecycleNode(package='nav2_amcl', executable='amcl', name='m', namespace='')",
         "navigation runs in compiled servers"),
        ("ExecuteProcess(cmd=['gz', 'sim'])", "`gz sim` cannot run here"),
        ("ExecuteProcess(cmd=['ros2', 'control', 'load_controller', 'a'])", "`ros2 control` cannot run here"),
        (
            "ExecuteProcess(cmd=['ros2', 'component', 'load', '/c', 'composition', 'composition::Talker'])",
            "`ros2 component load /c composition composition::Talker` cannot run here: there are no c",
        ),
        ("ExecuteProcess(cmd=['ros2', 'run', 'nowhere', 'x'])", "package 'nowhere' not found"),
        ("Node(**TALKER, parameters=[os.path.join(simulator, 'p.yaml')])", "package 'ros_gz_sim' not found"),
        ("Node(**TALKER, arguments=[os.path.join(simulator, 'p.rviz')])", "package 'ros_gz_sim' not found"),
        ("GroupAction([PushRosNamespace('a'), spawner])", "package 'ros_gz_sim' not found"),
        ("OpaqueFunction(function=lambda context: [spawner])", "package 'ros_gz_sim' not found"),
    ],
)  # fmt: skip
def test_action_that_cannot_run_is_skipped_with_one_line_and_the_others_start(
    launch_file: Write, robot: Path, capsys: pytest.CaptureFixture[str], action: str, reason: str
) -> None:
    (robot / "CMakeLists.txt").write_text("add_executable(driver src/driver.cpp)\n")
    imports = "from moveit_configs_utils import launches, MoveItConfigsBuilder"
    moveit = launch_file(
        "launches.generate_demo_launch(MoveItConfigsBuilder('arm'))", name="moveit.launch.py"
    )
    moveit.write_text(f"{imports}\n{moveit.read_text()}")
    file = launch_file(action, "Node(**TALKER)")
    file.write_text(file.read_text().replace("TALKER = dict", f"{GAZEBO}\nTALKER = dict"))
    recording, code = recorded(file)
    assert (count_published(recording), code) == ({"/chatter 'hi' --ros-args": 1}, 0)
    (line,) = [one for one in capsys.readouterr().out.splitlines() if one.startswith("[WARNING] [launch]")]
    assert re.match(
        rf"\[WARNING\] \[launch\]: \S+\.launch\.py, line \d+: [\w.]+ is left out: .*{reason}", line
    )


HELPERS = """
from moveit_configs_utils import MoveItConfigsBuilder
from moveit_configs_utils.launches import generate_demo_launch
config = MoveItConfigsBuilder("arm").robot_description(file_path="arm.urdf").to_moveit_configs()
"""


@pytest.mark.parametrize(
    "action",
    [
        "generate_demo_launch(config)",
        "Node(**TALKER, parameters=[config.robot_description])",
        "Node(**TALKER, parameters=[config.to_dict(), {'use_sim_time': True}])",
        "Node(**TALKER, parameters=[{**config.planning_pipelines, 'a': 1}])",
        "Node(**TALKER, arguments=[str(config.package_path / 'a.rviz')])",
        "LogInfo(msg=['path: ', config.package_path + '/a'])",
        "*generate_demo_launch(config).entities",
    ],
)
def test_action_using_a_module_of_a_missing_package_is_skipped(
    launch_file: Write, capsys: pytest.CaptureFixture[str], action: str
) -> None:
    file = launch_file(action, "Node(**TALKER)")
    file.write_text(file.read_text().replace("TALKER = dict", f"{HELPERS}\nTALKER = dict"))
    recording, code = recorded(file)
    assert (count_published(recording), code) == ({"/chatter 'hi' --ros-args": 1}, 0)
    out = capsys.readouterr().out
    assert out.count("left out: package 'moveit_configs_utils' not found: MoveIt's launch files") == 1


def test_launched_node_does_not_get_the_modules_imported_by_its_launch_file(
    launch_file: Write, robot: Path
) -> None:
    program = robot / "my_robot" / "talker.py"
    program.write_text(f"import moveit_configs_utils\n{program.read_text()}")
    file = launch_file("Node(**TALKER)")
    file.write_text(f"import moveit_configs_utils\n{file.read_text()}")
    recording, code = recorded(file)
    assert (count_published(recording), code) == ({}, 1)


def test_environment_variables_defined_by_a_ros_setup_can_be_extended(
    launch_file: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    file = launch_file("Node(**TALKER)")
    uses = "os.environ['GZ_SIM_RESOURCE_PATH'] += ':models'\nos.getenv('AMENT_PREFIX_PATH').split(':')"
    file.write_text(f"import os\n{uses}\n{file.read_text()}")
    recording, code = recorded(file)
    assert (count_published(recording), code) == ({"/chatter 'hi' --ros-args": 1}, 0)


def test_strict_launch_fails_on_an_action_that_cannot_run(launch_file: Write) -> None:
    file = launch_file("Node(**TALKER)", "Node(package='nowhere', executable='x')")
    recording, code = recorded(file, is_strict=True)
    assert (count_published(recording), code) == ({}, 1)


def test_handlers_of_a_skipped_process_run_except_for_a_shutdown(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    file = launch_file(
        "(spawner := Node(package='nowhere', executable='spawner', on_exit=Shutdown()))",
        "RegisterEventHandler(OnProcessStart(target_action=spawner, on_start=LogInfo(msg='started')))",
        "RegisterEventHandler(OnProcessExit(target_action=spawner, on_exit=["
        "Node(**TALKER), EmitEvent(event=ShutdownEvent(reason='done'))]))",
    )
    recording, code = recorded(file)
    assert (count_published(recording), code) == ({"/chatter 'hi' --ros-args": 1}, 0)
    assert "[launch.user]: started" in capsys.readouterr().out


def test_skipped_process_that_is_respawned_on_exit_does_not_loop(launch_file: Write) -> None:
    again = "lambda event, context: Node(package='nowhere', executable='x')"
    file = launch_file(
        "Node(package='nowhere', executable='x')",
        f"RegisterEventHandler(OnProcessExit(on_exit={again}))",
        "Node(**TALKER)",
    )
    assert recorded(file)[1] == 0


def test_unused_missing_package_is_reported_once(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    file = launch_file("LogInfo(msg=FindPackageShare('nowhere'))", "LogInfo(msg=FindPackageShare('nowhere'))")
    assert recorded(file)[1] == 1
    lines = capsys.readouterr().out.splitlines()[1:]
    assert lines[:2] == ["[INFO] [launch.user]: /opt/ros/jazzy/share/nowhere"] * 2
    assert len(lines) == 3
    assert "course export FILE --package nowhere" in lines[2]


def test_launched_program_raises_an_error_for_a_missing_package(
    launch_file: Write, robot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = "from ament_index_python.packages import *\ndef main():\n    get_package_prefix('nowhere')\n"
    (robot / "my_robot" / "talker.py").write_text(code)
    recorded(launch_file("Node(**TALKER)", "Node(package='nowhere', executable='x')"))
    assert "PackageNotFoundError: package 'nowhere' not found" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("action", "text"),
    [
        ("Node(package='my_robot',\n executable=5)", "'int' object is not iterable"),
        ("Node(**TALKER, parameters=[{'a': Command('echo name: b: c')}])",
         "Unable to parse the value of parameter a as yaml. If the parameter is meant to be a string, try "),
        ("Node(**TALKER, parameters=[{'a': [object()]}])", "Object of type object is not JSON"),
        ("LogInfo(msg=LaunchConfiguration('nope'))", "launch configuration 'nope' does not exist"),
        ("GroupAction([TimerAction(period='x', actions=[])])", "could not convert string to float: 'x'"),
    ],
)  # fmt: skip
def test_launch_error_reports_the_line_of_its_action_without_a_traceback(
    launch_file: Write, capsys: pytest.CaptureFixture[str], action: str, text: str
) -> None:
    file = launch_file(action)
    number = next(
        n for n, line in enumerate(file.read_text().splitlines(), 1) if action.partition("\n")[0] in line
    )
    assert recorded(file)[1] == 1
    captured = capsys.readouterr()
    (line,) = captured.out.splitlines()[1:]
    assert line.startswith(f"[ERROR] [launch]: Caught exception in launch (see debug for traceback): {text}")
    assert f"({file.name}, line {number}: " in line
    assert captured.err == ""


def test_error_in_the_launch_file_shows_a_traceback(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    _, code = recorded(launch_file("Node(**TALKER, paramters=[])"))
    assert code == 1
    assert (
        "TypeError: Node.__init__() got an unexpected keyword argument 'paramters'" in capsys.readouterr().err
    )


def test_launch_file_without_a_returned_description_is_an_error_with_the_missing_return(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "empty.launch.py"
    file.write_text("def generate_launch_description():\n    pass\n")
    assert recorded(file)[1] == 1
    assert "returned None; end it with: return LaunchDescription" in capsys.readouterr().out


def test_two_runs_of_a_launch_are_equal(launch_file: Write) -> None:
    file = launch_file("Node(**TALKER, name='a')", "Node(**TALKER, name='b', parameters=[{'rate': 20.0}])")
    assert recorded(file)[0].digest() == recorded(file)[0].digest()


def test_changed_package_is_reloaded(launch_file: Write, robot: Path) -> None:
    file = launch_file("Node(**TALKER)")
    recorded(file)
    source = robot / "my_robot" / "talker.py"
    source.write_text(source.read_text().replace('"hi"', '"changed"'))
    assert count_published(recorded(file)[0]) == {"/chatter 'changed' --ros-args": 1}


def test_program_arguments_without_a_launch_description_are_an_error(tmp_path: Path) -> None:
    (tmp_path / "program.py").write_text("print(1)")
    with pytest.raises(CourseError, match="generate_launch_description"):
        arguments_of(tmp_path / "program.py")


def test_file_named_like_a_launch_file_is_a_launch_file_even_without_a_description(tmp_path: Path) -> None:
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


def test_output_lines_of_a_process_have_its_name_as_prefix(
    launch_file: Write, robot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (robot / "my_robot" / "talker.py").write_text(WORDY)
    node = "Node(package='my_robot', executable='talker')"
    before = sys.stdout
    assert recorded(launch_file(node, node))[1] == 0
    assert sys.stdout is before
    captured = capsys.readouterr()
    lines = [line for line in captured.out.splitlines() if line.startswith("[talker-1]")]
    assert [line.removeprefix("[talker-1] ") for line in lines] == [
        *("one three", "four", "two three", "four", "no line end")
    ]
    assert captured.err == "[talker-1] to stderr\n[talker-2] to stderr\n"
    others = {line.split("]")[0] for line in captured.out.splitlines()}
    assert others == {"[INFO", "[talker-1", "[talker-2"}


def test_launched_process_receives_only_the_arguments_of_its_node(
    launch_file: Write, robot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (robot / "my_robot" / "talker.py").write_text("import sys\ndef main():\n    print(sys.argv[1:])\n")
    assert recorded(launch_file("Node(package='my_robot', executable='talker', arguments=['fast'])"))[1] == 0
    assert "[talker-1] ['fast', '--ros-args']\n" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        ("LogInfo(msg=LaunchConfiguration('nope'))", "'nope' does not exist"),
        ("'no action'", "AttributeError"),
    ],
)
def test_error_in_a_timer_ends_the_launch_and_its_processes(
    launch_file: Write, bad: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = launch_file("Node(**TALKER)", f"TimerAction(period=0.5, actions=[{bad}])")
    recording, code = recorded(file, seconds=None)
    assert (len(count_published(recording)), code) == (0, 1)
    captured = capsys.readouterr()
    assert message in captured.out + captured.err


def test_kit_program_with_wrong_arguments_is_an_error_without_kit_lines(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    talker = "Node(package='demo_nodes_py', executable='talker', ros_arguments=['--params-file', 'no.yaml'])"
    _, code = recorded(launch_file(talker))
    output = "".join(capsys.readouterr())
    assert code == 1
    assert "RCLError: failed to initialize rcl: Couldn't parse params file" in output
    assert "Traceback" not in output


def test_script_with_a_syntax_error_is_an_error_without_kit_lines(
    launch_file: Write, robot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (robot / "scripts").mkdir()
    (robot / "scripts" / "broken.py").write_text("def (")
    (robot / "CMakeLists.txt").write_text("install(PROGRAMS scripts/broken.py DESTINATION lib/my_robot)")
    _, code = recorded(launch_file("Node(package='my_robot', executable='broken.py')"))
    output = "".join(capsys.readouterr())
    assert code == 1
    assert re.search(r"CourseError: \S+broken.py, line 1: ", output)
    assert "Traceback" not in output


def test_paths_are_joined_with_slashes_and_modules_are_loaded_from_files(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    path = "LogInfo(msg=PathSubstitution(FindPackageShare('turtlesim')) / 'launch' / 'a.py')"
    _, code = recorded(launch_file(path))
    assert code == 0
    assert "turtlesim/launch/a.py" in capsys.readouterr().out
    module = load_python_launch_file_as_module(str(launch_file("LogInfo(msg='x')")))
    assert isinstance(module.generate_launch_description(), LaunchDescription)


def test_simulator_elements_in_xml_are_skipped(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    file = launch_file("LogInfo(msg='x')").with_name("sim.launch.xml")
    file.write_text('<launch><gz_server world_sdf_file="a"/><log message="and on"/></launch>')
    recorded(file)
    out = capsys.readouterr().out
    assert "sim.launch.xml, line 1: Action is left out: package 'ros_gz_sim' not found: Gazebo" in out
    assert "and on" in out


def test_error_in_a_kit_launch_file_reports_that_file(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    file = launch_file("LogInfo(msg='x')").with_name("show.launch.xml")
    file.write_text(
        '<launch><include file="$(find-pkg-share urdf_launch)/launch/display.launch.py"/></launch>'
    )
    _, code = recorded(file)
    assert code == 1
    error = r"launch configuration 'urdf_package' does not exist: .+ \(display\.launch\.py, line \d+: Include"
    assert re.search(error, "".join(capsys.readouterr()))
