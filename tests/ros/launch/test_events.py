"""Event handlers, coroutines and components in launch files."""

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.ros.launch.run import recorded

Write = Callable[..., Path]
ONCE = "(once := Node(package='my_robot', executable='once'))"


@pytest.fixture
def run_actions(launch_file: Write, capsys: pytest.CaptureFixture[str]) -> Callable[..., list[str]]:
    """Run a launch file of some actions to its end. Return its log lines in order."""

    def run(*actions: str, seconds: float | None = None, only: str = "launch.user") -> list[str]:
        recorded(launch_file(*actions), seconds=seconds)
        lines = capsys.readouterr().out.splitlines()
        return [line.split(": ", 1)[1] for line in lines if only in line]

    return run


def test_end_of_an_action_emits_an_event(run_actions: Callable[..., list[str]]) -> None:
    complete = (
        "RegisterEventHandler(OnExecutionComplete(target_action={}, on_completion=[LogInfo(msg='{}')]))"
    )
    assert run_actions(
        "(a := SetEnvironmentVariable('A', 'b')) and " + complete.format("a", "variable"),
        "a",
        ONCE,
        "(timer := TimerAction(period=1.0, actions=[LogInfo(msg='timer')]))",
        complete.format("once", "node"),
        complete.format("timer", "timer is over"),
    ) == ["variable", "node", "timer", "timer is over"]


def test_process_output_triggers_on_process_io(run_actions: Callable[..., list[str]]) -> None:
    heard = "lambda event: LogInfo(msg=event.text.decode().strip() + ' of ' + event.process_name)"
    assert run_actions(
        f"RegisterEventHandler(OnProcessIO(on_stdout={heard}))",
        "ExecuteProcess(cmd=[['ros2 pkg ', 'prefix my_robot']], shell=True)",
    )[0].endswith(" of ros2-1")


def test_echo_and_sleep_run_on_robot_time(launch_file: Write, capsys: pytest.CaptureFixture[str]) -> None:
    file = launch_file(
        "ExecuteProcess(cmd=['sleep', '2'], on_exit=ExecuteProcess(cmd=[['echo well ', 'rested']]))",
        "TimerAction(period=1.0, actions=[LogInfo(msg='still asleep')])",
    )
    assert recorded(file, seconds=None)[1] == 0
    out = capsys.readouterr().out
    assert out.index("still asleep") < out.index("[echo-2] well rested")


def test_process_event_ends_only_the_matching_processes(run_actions: Callable[..., list[str]]) -> None:
    talker = "Node(**TALKER, name='{}', on_exit=LogInfo(msg='end of {}'))"
    end = "EmitEvent(event={}(process_matcher=matches_action(a){}))"
    for event, more in (("ShutdownProcess", ""), ("SignalProcess", ", signal_number='SIGINT'")):
        assert run_actions(
            f"(a := {talker.format('a', 'a')})",
            talker.format("b", "b"),
            f"TimerAction(period=0.5, actions=[{end.format(event, more)}])",
            "TimerAction(period=2.0, actions=[LogInfo(msg='later'), Shutdown()])",
        ) == ["end of a", "later", "end of b"]


def test_signals_other_than_termination_signals_end_no_process(run_actions: Callable[..., list[str]]) -> None:
    signal = "SignalProcess(process_matcher=matches_action(a), signal_number='SIGUSR1')"
    assert run_actions(
        "(a := Node(**TALKER, on_exit=LogInfo(msg='end')))",
        f"EmitEvent(event={signal})",
        "TimerAction(period=1.0, actions=[LogInfo(msg='later'), Shutdown()])",
    ) == ["later", "end"]


def test_event_is_in_the_locals_of_its_handler(run_actions: Callable[..., list[str]]) -> None:
    code = "LogInfo(msg=['code ', LocalSubstitution('event.returncode')])"
    fail = "(fail := Node(package='my_robot', executable='fail'))"
    assert run_actions(f"RegisterEventHandler(OnProcessExit(on_exit=[{code}]))", fail) == ["code 1"]


WAITS = """
import asyncio, time
async def waits(name):
    begun = time.time()
    print(name, "waits")
    await asyncio.sleep(2)
    print(f"{name} waited {time.time() - begun:.1f} s")
"""


def test_coroutine_runs_on_robot_time_concurrently_with_processes(
    launch_file: Write, robot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (robot / "my_robot" / "waits.py").write_text(WAITS)
    coroutine = "__import__('my_robot.waits', fromlist=['waits']).waits"
    recorded(
        launch_file(
            f"OpaqueCoroutine(coroutine={coroutine}, args=['x'], ignore_context=True)",
            "TimerAction(period=1.5, actions=[LogInfo(msg='between')])",
        ),
        seconds=None,
    )
    out = capsys.readouterr().out
    texts = ("x waits", "between", "x waited 2.0 s")
    assert [text for line in out.splitlines() for text in texts if text in line] == [*texts]


def test_exit_of_a_required_process_ends_the_launch(run_actions: Callable[..., list[str]]) -> None:
    node = "Node(package='my_robot', executable='once', on_exit=Shutdown())"
    texts = run_actions("Node(**TALKER)", node, only="[launch]")
    assert texts[-1] == "process[once-2] was required: shutting down launched system"


COMPONENT = "ComposableNode(package='my_robot', plugin='{}', name='c', parameters=[{{'word': 'x'}}])"


def test_python_component_is_started_and_cpp_component_is_skipped_with_a_notice(
    launch_file: Write, robot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    setup = (robot / "setup.py").read_text()
    (robot / "setup.py").write_text(
        setup.replace('"fail =', '"my_robot::Talker = my_robot.talker:Talker", "fail =')
    )
    both = ", ".join(COMPONENT.format(plugin) for plugin in ("my_robot::Talker", "my_robot::Driver"))
    container = "name='box', namespace='', package='rclcpp_components', executable='component_container'"
    file = launch_file(f"ComposableNodeContainer({container}, composable_node_descriptions=[{both}])")
    recording, _ = recorded(file)
    assert [s.topic for s in recording.samples if s.type_name == "std_msgs/msg/String"] == ["/chatter"]
    [line] = [line for line in capsys.readouterr().out.splitlines() if "[ERROR]" in line]
    assert "component 'my_robot::Driver' of package 'my_robot' is left out: it is a C++ plugin" in line
    assert "course run FILE --robot" in line


@pytest.mark.parametrize(
    ("package", "plugin", "why"),
    [
        ("nav2_amcl", "nav2_amcl::AmclNode", "navigation runs in compiled servers, which pip can't install"),
        ("nowhere", "nowhere::Node", "it is a C++ plugin, and this kit runs Python only"),
    ],
)
def test_component_of_a_missing_package_is_skipped_with_a_notice(
    launch_file: Write, capsys: pytest.CaptureFixture[str], package: str, plugin: str, why: str
) -> None:
    load = f"[ComposableNode(package='{package}', plugin='{plugin}')]"
    file = launch_file(
        f"LoadComposableNodes(composable_node_descriptions={load}, target_container='box')",
        "LogInfo(msg='on')",
    )
    assert recorded(file)[1] == 0
    out = capsys.readouterr().out
    assert f"component '{plugin}'" in out
    assert why in out
    assert "[launch.user]: on" in out


def test_kit_nodes_loaded_as_components_are_started(launch_file: Write) -> None:
    plugin = "robot_state_publisher::RobotStatePublisher"
    urdf = '<robot name="r"><link name="a"/></robot>'
    component = (
        f"ComposableNode(package='robot_state_publisher', plugin='{plugin}', "
        f"parameters=[{{'robot_description': '{urdf}'}}])"
    )
    file = launch_file(
        f"LoadComposableNodes(composable_node_descriptions=[{component}], target_container='box')"
    )
    assert "/robot_description" in {sample.topic for sample in recorded(file)[0].samples}


def test_second_launch_reloads_a_changed_module(
    launch_file: Write, robot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    module = robot / "my_robot" / "words.py"
    message = "LogInfo(msg=__import__('my_robot.words', fromlist=['WORD']).WORD)"
    for word in ("before", "after, and longer"):
        module.write_text(f"WORD = {word!r}\n")
        recorded(launch_file(message), seconds=None)
        assert word in capsys.readouterr().out


@pytest.mark.parametrize(
    ("option", "says"),
    [
        ("respawn=True", True),
        ("respawn=LaunchConfiguration('r', default='false')", False),
        ("cwd='/tmp'", True),
    ],
)
def test_option_without_effect_in_the_kit_is_reported(
    launch_file: Write, option: str, says: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    recorded(launch_file(f"ExecuteProcess(cmd=['echo', 'hello'], {option})"), seconds=None)
    out = capsys.readouterr().out
    assert "hello" in out
    assert (f"[WARNING] [launch]: {option.partition('=')[0]}: no effect here" in out) == says
