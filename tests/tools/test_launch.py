from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import rclpy

from course_lib.displays.viewer import Viewer
from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.time.driving import live_runs, spin_for
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import GraphSource
from tests.ros.launch.conftest import launch_file as launch_file
from tests.ros.launch.conftest import robot as robot

Run = Callable[..., Path]


@pytest.fixture
def graph(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Graph]:
    """A notebook's graph, in a folder with the package my_robot."""
    from course_lib.ros.time import virtual_time

    virtual_time.install()
    monkeypatch.setenv("COURSE_PACE", "fast")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    with use_graph(Graph(notebook=True)) as graph:
        yield graph
        for run in live_runs(graph):
            run.stop()
        rclpy.try_shutdown()


def run(graph: Graph, line: str) -> None:
    """Run a command line."""
    ros2(line.split(), GraphSource(graph), print)


def names(graph: Graph) -> list[str]:
    return sorted(node.name for node in graph.nodes())


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("hi_launch.yaml", "launch:\n- log: {message: hi}\n"),
        ("hi.launch.xml", "<launch><log message='hi'/></launch>"),
    ],
)
def test_xml_and_yaml_launch_files_of_a_package_are_found(
    graph: Graph, robot: Path, name: str, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (robot / "launch" / name).write_text(text)
    run(graph, f"launch my_robot {name}")
    assert "[INFO] [launch.user]: hi\n" in capsys.readouterr().out


@pytest.mark.slow
def test_kit_packages_have_their_launch_files(graph: Graph, launch_file: Run) -> None:
    run(graph, "launch turtlesim multisim.launch.py")
    assert names(graph).count("turtlesim") == 2
    share = "PathJoinSubstitution([FindPackageShare('turtlesim'), 'launch', 'multisim.launch.py'])"
    launch_file(f"IncludeLaunchDescription({share})", "Node(**TALKER)")
    run(graph, "launch my_robot robot.launch.py")
    spin_for(0.1)
    assert names(graph).count("turtlesim") == 4
    with pytest.raises(CourseError, match="which has: turtlesim_node"):
        run(graph, "run turtlesim turtle")


def test_launch_continues_between_cells_until_stopped(graph: Graph, launch_file: Run) -> None:
    launch_file("Node(**TALKER, name='a')", "Node(**TALKER, name='b')")
    run(graph, "launch my_robot robot.launch.py")
    received: list[str] = []
    graph.tap(lambda sample: received.append(sample.topic))
    spin_for(2.0)
    assert received.count("/chatter") == 4
    (launched,) = live_runs(graph)
    assert launched.state().startswith("▶ running: robot.launch.py")
    launched.stop()
    spin_for(2.0)
    assert received.count("/chatter") == 4
    assert live_runs(graph) == ()


def test_invisible_view_finally_shows_the_received_messages(
    graph: Graph, launch_file: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    observed: list[str] = []

    class Shown:
        def update(self, viewer: Viewer) -> None:
            observed.append(str(viewer.statuses()))

    def display(viewer: Viewer, display_id: bool) -> Shown:
        Shown().update(viewer)
        return Shown()

    monkeypatch.setattr("IPython.display.display", display)
    frames = ["--frame-id", "map", "--child-frame-id", "base_link"]
    launch_file(
        "Node(package='rviz2', executable='rviz2')",
        f"Node(package='tf2_ros', executable='static_transform_publisher', arguments={frames})",
    )
    run(graph, "launch my_robot robot.launch.py")
    spin_for(2.0)
    assert ["does not exist" in statuses for statuses in observed] == [True, False]


@pytest.mark.parametrize(
    ("options", "follows"),
    [
        ("", False),
        ("parameters=[{'use_sim_time': True}]", True),
        ("parameters=[{'use_sim_time': False}]", False),
        ("name='view', ros_arguments=['-p', 'view:use_sim_time:=true']", True),
        # The prefix stands for /view.
        ("name='view', namespace='a', ros_arguments=['-p', 'view:use_sim_time:=true']", False),
        ("name='view', ros_arguments=['-p', 'rviz2:use_sim_time:=true']", False),
    ],
)
def test_rviz_in_a_launch_file_uses_its_use_sim_time_parameter(
    graph: Graph, launch_file: Run, monkeypatch: pytest.MonkeyPatch, options: str, follows: bool
) -> None:
    observed: list[bool] = []

    def display(viewer: Viewer, display_id: bool) -> None:
        observed.append(viewer.use_sim_time)

    monkeypatch.setattr("IPython.display.display", display)
    launch_file(f"Node(package='rviz2', executable='rviz2', {options})")
    run(graph, "launch my_robot robot.launch.py")
    spin_for(1.0)
    assert observed == [follows]


def test_repeated_launch_replaces_the_first(graph: Graph, launch_file: Run) -> None:
    launch_file("Node(**TALKER)")
    for _ in range(2):
        run(graph, "launch my_robot robot.launch.py")
    assert names(graph).count("talker") == 1
    assert len(live_runs(graph)) == 1


def test_run_starts_one_executable_with_its_arguments(graph: Graph, robot: Path) -> None:
    run(graph, "run my_robot talker --ros-args -r __node:=other")
    assert "other" in names(graph)


def test_finished_launch_is_not_listed_as_running(graph: Graph, launch_file: Run) -> None:
    launch_file("Node(package='my_robot', executable='fail')")
    run(graph, "launch my_robot robot.launch.py")
    assert live_runs(graph) == ()


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("launch my_robt robot.launch.py", "package 'my_robt' not found"),
        ("launch my_robot other.launch.py", "There is: robot.launch.py"),
        ("launch nowhere.launch.py", "No such launch file"),
        ("run my_robot talkr", "Did you mean talker"),
    ],
)
def test_unknown_package_launch_file_or_executable_is_reported(
    graph: Graph, launch_file: Run, line: str, message: str
) -> None:
    launch_file("Node(**TALKER)")
    with pytest.raises(CourseError, match=message):
        run(graph, line)


def test_launch_file_of_a_package_can_have_any_name(
    graph: Graph, launch_file: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    file = launch_file("DeclareLaunchArgument('word', default_value='hi')", "Node(**TALKER)")
    file.rename(file.with_name("bringup.py"))
    with pytest.raises(CourseError, match=r"There is: bringup\.py\."):
        run(graph, "launch my_robot robot.launch.py")
    run(graph, "launch my_robot bringup.py --show-args")
    assert "'word'" in capsys.readouterr().out


def test_launch_arguments_are_shown_without_starting_processes(
    graph: Graph, launch_file: Run, capsys: pytest.CaptureFixture[str]
) -> None:
    launch_file("DeclareLaunchArgument('word', default_value='hi')", "Node(**TALKER)")
    run(graph, "launch my_robot robot.launch.py --show-args")
    assert "'word':" in capsys.readouterr().out
    assert names(graph) == []
