from math import isnan, sin

import numpy as np
import pytest
from rclpy.node import Node

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time.driving import spin_for
from course_lib.tools.rqt.monitors import PlotView, parse

TOPICS = {
    "/arm/joint_states": ["sensor_msgs/msg/JointState"],
    "/pose": ["geometry_msgs/msg/PoseStamped"],
    "/on": ["std_msgs/msg/Bool"],
    "/odom": ["nav_msgs/msg/Odometry"],
}


def test_plot_paths_are_resolved_to_numeric_fields() -> None:
    from geometry_msgs.msg import PoseStamped
    from sensor_msgs.msg import JointState
    from std_msgs.msg import Bool

    pose = PoseStamped()
    pose.pose.position.x = 3.5
    assert parse("/pose/pose/position/x", TOPICS).read(pose) == 3.5
    assert parse("on/data", TOPICS).read(Bool(data=True)) == 1.0
    second = parse("/arm/joint_states/position[1]", TOPICS)
    assert second.read(JointState(position=[1.0, 2.0])) == 2.0
    assert isnan(second.read(JointState(position=[1.0])))


@pytest.mark.parametrize(
    ("path", "message"),
    [
        (
            "/arm/joint_stats/position[0]",
            r"topic /arm/joint_stats/position\[0\] does not exist. Did you mean /arm/joint",
        ),
        ("/on", 'no field specified in topic name "/on". Numbers here: /on/data'),
        ("/pose/pose/positon/x", "geometry_msgs/msg/Pose has no field 'positon'. Did you mean position"),
        ("/pose/pose/position", "/pose/pose/position is not a number. Numbers here: /pose/pose/position/x"),
        ("/pose/header/frame_id", "is not a number"),
        ("/arm/joint_states/position", r"position is a list. Add an index, like position\[0\]"),
        ("/pose/pose/position/x[0]", "x is not a list"),
        ("/odom/pose/covariance[36]", "covariance is a list of 36"),
        ("/on/data/x", "a number has no field 'x'"),
    ],
)
def test_invalid_path_is_explained(path: str, message: str) -> None:
    with pytest.raises(CourseError, match=message):
        parse(path, TOPICS)


def test_curves_show_received_values_by_robot_time(graph: Graph, arm: Node) -> None:
    view = PlotView(graph, ["/arm/joint_states/position[0]"])
    start_ns = graph.now_ns
    view.listen()
    spin_for(1.0)
    ((_, points),) = view.curves.values()
    assert len(points) == 20
    assert points[3][0] == pytest.approx(0.2)
    assert points[3][1] == pytest.approx(sin(start_ns * 1e-9 + 0.2), abs=1e-6)
    assert f"/arm/joint_states/position[0] = {points[-1][1]:.4g}" in view.picture()


def test_added_curves_keep_existing_points(graph: Graph, arm: Node) -> None:
    view = PlotView(graph, ["/arm/joint_states/position[0]"])
    view.listen()
    spin_for(0.5)
    view.controls["Topics"].value += " /arm/joint_states/position[1]"
    spin_for(0.5)
    assert [len(points) for _, points in view.curves.values()] == [20, 10]
    view.clear()
    assert "no message yet" in view.picture()


def test_paused_plot_keeps_its_image_while_messages_are_received(graph: Graph, arm: Node) -> None:
    view = PlotView(graph, ["/arm/joint_states/position[1]"])
    view.listen()
    spin_for(0.5)
    view.refresh()
    before = view.screen.value
    view.controls["Pause"].value = True
    spin_for(0.5)
    view.refresh()
    assert view.screen.value == before
    view.controls["Pause"].value = False
    assert view.screen.value != before


@pytest.mark.slow
def test_long_curve_is_downsampled_and_keeps_its_peaks(graph: Graph, arm: Node) -> None:
    view = PlotView(graph, ["/arm/joint_states/position[0]"])
    view.controls["Autoscroll"].value = False
    ((_, points),) = view.curves.values()
    noise = np.random.default_rng(0).normal(0, 0.1, 100_000)
    flat = [(number * 1e-5, value) for number, value in enumerate(noise.tolist())]
    points.extend(flat)
    spread = view.picture()
    points[54_321] = (0.54321, 9.0)
    assert len(spread) < 200_000
    assert "nan" not in spread
    assert ">8<" in view.picture()  # the axis extends to the peak
    assert ">8<" not in spread
