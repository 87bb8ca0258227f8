from collections.abc import Callable
from pathlib import Path

import pytest
from ament_index_python import get_package_share_path

from course_lib import Viewer
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


def test_publishers_of_a_robot_work_together(launch_file: Write) -> None:
    file = launch_file(
        kit("robot_state_publisher", parameters=[{"robot_description": URDF, "publish_frequency": 50.0}]),
        kit("joint_state_publisher_gui", parameters=[{"rate": 20}]),
    )
    recording, code = recorded(file)
    counts = {topic.name: topic.count for topic in recording.topics()}
    assert code == 0
    assert (counts["/robot_description"], counts["/joint_states"], counts["/tf"]) == (1, 20, 19)


def test_description_as_parameter_and_argument_is_published_once(launch_file: Write) -> None:
    parameters = [{"robot_description": URDF}]
    file = launch_file(kit("robot_state_publisher", parameters=parameters, arguments=[URDF]))
    recording, code = recorded(file)
    assert code == 0
    assert {topic.name: topic.count for topic in recording.topics()}["/robot_description"] == 1


@pytest.mark.parametrize(
    "words",
    [
        ["1", "0", "0", "0", "0", "-1.5", "world", "base"],
        ["1", "0", "0", "-0.681639", "0", "0", "0.731689", "world", "base"],
        ["--x", "1", "--roll", "-1.5", "--frame-id", "world", "--child-frame-id", "base"],
    ],
)
def test_static_transform_accepts_old_and_new_style_arguments(launch_file: Write, words: list[str]) -> None:
    recording, code = recorded(launch_file(kit("static_transform_publisher", "tf2_ros", arguments=words)))
    ((_, message),) = recording.messages("/tf_static")
    transform = message.transforms[0]  # type: ignore[attr-defined]  # of type TFMessage
    assert code == 0
    assert (transform.header.frame_id, transform.child_frame_id) == ("world", "base")
    assert (transform.transform.translation.x, round(transform.transform.rotation.x, 3)) == (1.0, -0.682)


def test_rviz_without_a_page_prints_how_to_view_its_layout(
    launch_file: Write, robot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    layout = robot / "config" / "my.rviz"
    layout.write_text("Visualization Manager:\n  Displays: []\n")
    assert recorded(launch_file(kit("rviz2", arguments=["-d", str(layout)])))[1] == 0
    assert f"course view --bag DIR --rviz {layout}" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("action", "message"),
    [
        (kit("robot_state_publisher"), "robot_description parameter must not be empty"),
        (
            kit("static_turtle_tf2_broadcaster", "turtle_tf2_py", arguments=["world", *"000000"]),
            'Your static turtle name cannot be "world"',
        ),
    ],
)
def test_argument_errors_are_one_line(
    launch_file: Write, capsys: pytest.CaptureFixture[str], action: str, message: str
) -> None:
    assert recorded(launch_file(action))[1] == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line


def test_turtlesim_without_a_page_prints_how_to_see_its_window(
    launch_file: Write, capsys: pytest.CaptureFixture[str]
) -> None:
    recording, code = recorded(launch_file(kit("turtlesim_node", "turtlesim")))
    counts = {topic.name: topic.count for topic in recording.topics()}
    assert (code, counts["/turtle1/pose"], counts["/turtle1/color_sensor"]) == (0, 62, 62)
    captured = capsys.readouterr()
    assert "%ros2 run turtlesim turtlesim_node" in captured.out + captured.err


def test_rqt_and_tf2_tools_are_available(launch_file: Write, capsys: pytest.CaptureFixture[str]) -> None:
    echo = kit("tf2_echo", "tf2_ros", arguments=["world", "base"])
    assert recorded(launch_file(kit("rqt_graph"), echo))[1] == 0
    captured = capsys.readouterr()
    assert "%rqt graph" in captured.out
    assert "Waiting for transform world ->  base" in captured.out + captured.err


def demo(name: str) -> str:
    return f"Node(package='demo_nodes_py', executable={name!r})"


def test_demo_nodes_talk_listen_and_add(launch_file: Write, capfd: pytest.CaptureFixture[str]) -> None:
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


def test_demo_nodes_in_cpp_have_their_own_output(
    launch_file: Write, capfd: pytest.CaptureFixture[str]
) -> None:
    names = ("talker", "listener", "parameter_blackboard")
    actions = [kit(name, "demo_nodes_cpp", parameters=[{"a": 1}]) for name in names]
    recording, code = recorded(launch_file(*actions), seconds=1.5)
    assert code == 0
    assert [message.data for _, message in recording.messages("/chatter")] == [  # type: ignore[attr-defined]
        "Hello World: 1"
    ]
    printed = capfd.readouterr().err
    assert "Publishing: 'Hello World: 1'" in printed
    assert "I heard: [Hello World: 1]" in printed
    assert "Parameter blackboard node named '/parameter_blackboard' ready" in printed


def test_component_of_demo_nodes_cpp_starts(launch_file: Write, capfd: pytest.CaptureFixture[str]) -> None:
    talker = "ComposableNode(package='demo_nodes_cpp', plugin='demo_nodes_cpp::Talker')"
    container = "package='rclcpp_components', executable='component_container', name='c', namespace=''"
    file = launch_file(f"ComposableNodeContainer({container}, composable_node_descriptions=[{talker}])")
    assert recorded(file, seconds=1.5)[1] == 0
    assert "Publishing: 'Hello World: 1'" in capfd.readouterr().err


def test_other_demo_node_in_cpp_is_left_out(launch_file: Write, capsys: pytest.CaptureFixture[str]) -> None:
    file = launch_file(kit("one_off_timer", "demo_nodes_cpp"), kit("talker", "demo_nodes_cpp"))
    assert recorded(file, seconds=0.5)[1] == 0
    assert "executable 'one_off_timer' of package 'demo_nodes_cpp' not found" in capsys.readouterr().out


def test_service_call_in_a_launch_ends_without_an_error_at_its_end(
    launch_file: Write, capfd: pytest.CaptureFixture[str]
) -> None:
    call = "ExecuteProcess(cmd=['ros2', 'service', 'call', '/nowhere', 'std_srvs/srv/Trigger'])"
    assert recorded(launch_file(call, kit("talker", "demo_nodes_py")))[1] == 0
    printed = capfd.readouterr()
    assert "waiting for service to become available..." in printed.out
    assert "RCLError" not in printed.out + printed.err


@pytest.mark.parametrize(("name", "child"), [("", "turtle1"), ("_fixed_frame", "carrot1")])
def test_second_turtle_of_the_tf2_demo_follows_the_target_frame(name: str, child: str) -> None:
    launch = get_package_share_path("turtle_tf2_py") / "launch" / f"turtle_tf2{name}_demo.launch.py"
    recording, code = recorded(launch, seconds=25.0)
    assert code == 0
    frames = {
        transform.child_frame_id
        for _, message in recording.messages("/tf")
        for transform in message.transforms  # type: ignore[attr-defined]  # of type TFMessage
    }
    assert {"turtle1", "turtle2", child} <= frames
    *_, (_, pose) = recording.messages("/turtle2/pose")
    # The first turtle stays where it is, and carrot1 is two meters to its left.
    target = (5.544, 5.544 + 2.0 * (child == "carrot1"))
    assert (pose.x, pose.y) == pytest.approx(target, abs=0.2)  # type: ignore[attr-defined]  # of type Pose


def test_dynamic_frame_circles_around_the_first_turtle() -> None:
    launch = get_package_share_path("turtle_tf2_py") / "launch" / "turtle_tf2_dynamic_frame_demo.launch.py"
    recording, _ = recorded(launch, seconds=3.0)
    carrots = [
        transform.transform.translation
        for _, message in recording.messages("/tf")
        for transform in message.transforms  # type: ignore[attr-defined]  # of type TFMessage
        if transform.child_frame_id == "carrot1"
    ]
    assert {round(carrot.y) for carrot in carrots} == {-10, 10}


def test_layout_of_turtle_tf2_py_shows_the_frames_of_the_turtles() -> None:
    layout = get_package_share_path("turtle_tf2_py") / "rviz" / "turtle_rviz.rviz"
    viewer = Viewer.from_rviz(layout)
    assert repr(viewer) == "<Viewer of world with Grid, TF>"
