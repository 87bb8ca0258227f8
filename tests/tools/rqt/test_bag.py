from pathlib import Path

import pytest
from rclpy.node import Node
from sensor_msgs.msg import JointState

from course_lib.errors import CourseError
from course_lib.recording import record, write_bag
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time.driving import spin_for
from course_lib.tools.rqt.monitors import BagView


@pytest.fixture
def view(graph: Graph, arm: Node, tmp_path: Path) -> BagView:
    with record(graph) as recorder:
        spin_for(1.0)
    write_bag(recorder.recording(), tmp_path / "bag")
    arm.destroy_node()
    return BagView(graph, [str(tmp_path / "bag")])


def test_each_topic_has_a_line_with_its_count(view: BagView) -> None:
    assert ">/arm/joint_states</text>" in view.picture()
    assert ">20</text>" in view.picture()


def test_cursor_shows_the_last_message_before_it(view: BagView) -> None:
    view.controls["Message of"].value = "/arm/joint_states"
    view.controls["Time [s]"].value = 0.52
    assert "at 0.500 s" in view.picture() or "at 0.499" in view.picture()


def test_playing_publishes_each_message_once_with_its_topic(view: BagView, graph: Graph) -> None:
    messages: list[JointState] = []
    node = Node("listener")
    node.create_subscription(JointState, "/arm/joint_states", messages.append, 50)
    for seconds in (0.3, 0.7, view.controls["Time [s]"].max):
        view.play_to(seconds)
    spin_for(0.1, node)
    assert len(messages) == 20
    view.stop()
    assert [n.name for n in graph.nodes()] == ["listener"]


def test_playback_without_publishing_only_moves_the_cursor(view: BagView, graph: Graph) -> None:
    view.controls["Publish"].value = False
    view.play_to(0.5)
    assert "rosbag2_player" not in [node.name for node in graph.nodes()]


def test_bag_argument_is_required(graph: Graph) -> None:
    with pytest.raises(CourseError, match="Add the folder of a bag from ros2 bag record: %rqt bag FOLDER"):
        BagView(graph, [])
