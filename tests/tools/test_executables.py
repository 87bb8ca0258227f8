from collections.abc import Callable
from pathlib import Path

import pytest

from tests.ros.launch.conftest import launch_file as launch_file
from tests.ros.launch.conftest import robot as robot
from tests.ros.launch.run import recorded

Write = Callable[..., Path]
URDF = (
    '<robot name="r"><link name="base"/><link name="arm"/><joint name="j" type="revolute">'
    '<parent link="base"/><child link="arm"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
    "</robot>"
)


def kit(name: str, package: str = "", **options: object) -> str:
    """Describe an executable of the kit, whose package is called like it."""
    words = "".join(f", {key}={value!r}" for key, value in options.items())
    return f"Node(package={package or name!r}, executable={name!r}{words})"


def test_a_robot_s_publishers_work_together(launch_file: Write) -> None:
    file = launch_file(
        kit("robot_state_publisher", parameters=[{"robot_description": URDF, "publish_frequency": 50.0}]),
        kit("joint_state_publisher_gui", parameters=[{"rate": 20}]),
    )
    recording, code = recorded(file)
    counts = {topic.name: topic.count for topic in recording.topics()}
    assert code == 0
    assert (counts["/robot_description"], counts["/joint_states"], counts["/tf"]) == (1, 20, 19)


@pytest.mark.parametrize(
    "words",
    [
        ["1", "0", "0", "0", "0", "-1.5", "world", "base"],
        ["1", "0", "0", "-0.681639", "0", "0", "0.731689", "world", "base"],
        ["--x", "1", "--roll", "-1.5", "--frame-id", "world", "--child-frame-id", "base"],
    ],
)
def test_a_static_transform_is_given_in_the_old_way_and_the_new(launch_file: Write, words: list[str]) -> None:
    recording, code = recorded(launch_file(kit("static_transform_publisher", "tf2_ros", arguments=words)))
    ((_, message),) = recording.messages("/tf_static")
    transform = message.transforms[0]  # type: ignore[attr-defined]  # of type TFMessage
    assert code == 0
    assert (transform.header.frame_id, transform.child_frame_id) == ("world", "base")
    assert (transform.transform.translation.x, round(transform.transform.rotation.x, 3)) == (1.0, -0.682)


def test_rviz_without_a_page_says_how_its_layout_is_looked_at(
    launch_file: Write, robot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    layout = robot / "config" / "my.rviz"
    layout.write_text("Visualization Manager:\n  Displays: []\n")
    assert recorded(launch_file(kit("rviz2", arguments=["-d", str(layout)])))[1] == 0
    assert f"course view --bag DIR --rviz {layout}" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("action", "said"),
    [
        (kit("robot_state_publisher"), "robot_description parameter must not be empty"),
        (kit("rviz2", arguments=["-d", "missing.rviz"]), "missing.rviz"),
    ],
)
def test_what_is_wrong_with_arguments_is_one_line(
    launch_file: Write, capsys: pytest.CaptureFixture[str], action: str, said: str
) -> None:
    assert recorded(launch_file(action))[1] == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line


def test_turtlesim_runs_and_says_where_its_window_is(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    recording, code = recorded(launch_file(kit("turtlesim_node", "turtlesim")))
    counts = {topic.name: topic.count for topic in recording.topics()}
    assert (code, counts["/turtle1/pose"], counts["/turtle1/color_sensor"]) == (0, 62, 62)
    shown = capsys.readouterr()
    assert "%ros2 run turtlesim turtlesim_node" in shown.out + shown.err


def test_rqt_and_tools_of_tf2_are_there(launch_file: Write, capsys: pytest.CaptureFixture[str]) -> None:
    echo = kit("tf2_echo", "tf2_ros", arguments=["world", "base"])
    assert recorded(launch_file(kit("rqt_graph"), echo))[1] == 0
    shown = capsys.readouterr()
    assert "%rqt graph" in shown.out
    assert "Waiting for transform world ->  base" in shown.out + shown.err


def demo(name: str) -> str:
    return f"Node(package='demo_nodes_py', executable={name!r})"


def test_the_demo_nodes_talk_listen_and_add(launch_file: Write, capfd: pytest.CaptureFixture[str]) -> None:
    names = ("talker", "listener", "add_two_ints_server", "add_two_ints_client")
    recording, code = recorded(launch_file(*map(demo, names)), seconds=2.5)
    assert code == 0
    assert [message.data for _, message in recording.messages("/chatter")] == [  # type: ignore[attr-defined]
        "Hello World: 0",
        "Hello World: 1",
    ]
    printed = capfd.readouterr().err
    for line in ("I heard: [Hello World: 1]", "Incoming request\n", "a: 2 b: 3", "Result of add_two_ints: 5"):
        assert line in printed
