"""Programs of the course on one kit, seen and driven from another through `course router`."""

import re
from collections.abc import Callable
from itertools import cycle
from pathlib import Path

import pytest
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from course_lib import Viewer
from course_lib.demo import red_cube
from course_lib.ros.graph.graph import use_graph
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages import serialize, type_name
from course_lib.ros.robot.connect import RobotAddress, link_to
from course_lib.ros.robot.robot_graph import RobotGraph
from course_lib.ros.time import wall
from tests.gateway.conftest import ROSTER, Opened
from tests.gateway.test_router import Started, says, started, users_in
from tests.patience import PATIENCE
from tests.ports import free_port

__all__ = ["started"]
PAINTING = """
import rclpy
from rclpy.executors import SingleThreadedExecutor

from course_lib.robots import (
    START, JointTrajectoryController, OmniBase, PaintNode, RobotStatePublisher, mobile_manipulator,
)

rclpy.init()
urdf = mobile_manipulator().urdf
arm = JointTrajectoryController(urdf, start=START)
executor = SingleThreadedExecutor()
for node in (OmniBase(), arm, RobotStatePublisher(urdf), PaintNode()):
    executor.add_node(node)
try:
    executor.spin()
except KeyboardInterrupt:
    rclpy.try_shutdown()
"""
ARM = "/arm_controller/joint_trajectory"
PREFIX = "ur10"
JOINTS = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
SENT = ("/visualization_marker", "/tf", "/tf_static", "/robot_description", "/joint_states")


def lifted(angle: float) -> bytes:
    """Return a movement of the arm: the shoulder's lift [rad], in one second."""
    point = JointTrajectoryPoint(positions=[0.0, angle, 0.5, 0.0, 0.0, 0.0], velocities=[0.0] * 6)
    point.time_from_start.sec = 1
    names = [f"{PREFIX}{joint}_joint" for joint in JOINTS]
    return serialize(JointTrajectory(joint_names=names, points=[point]))


def advance_until(graph: RobotGraph, state: Callable[[], object], what: str) -> None:
    end = wall.monotonic() + PATIENCE
    while not state():
        assert wall.monotonic() < end, what
        graph.advance()


@pytest.mark.slow
def test_red_cube_and_painting_robot_work_from_another_kit(
    tmp_path: Path, started: Started, opened: Opened
) -> None:
    (tmp_path / "roster.csv").write_text(ROSTER)
    (tmp_path / "painting.py").write_text(PAINTING)
    place, there = (f"tcp/127.0.0.1:{free_port()}" for _ in range(2))
    opened(mode="router", **{"listen/endpoints": [there]})
    words = ("--robot", there, "--send", ARM, "--students", "roster.csv", "--driver", "1234")
    says(started("router", "--listen", place, *words), "router is linked")
    sends = [word for topic in SENT for word in ("--send", topic)]
    started("run", str(red_cube.__file__), "--robot", there, *sends)
    says(started("run", "painting.py", "--robot", there, *sends), "Robot initialized")
    ann = users_in(tmp_path)[1]
    student = link_to(RobotAddress(ann.address(place), send=[ARM]))
    with use_graph(student):
        viewer = Viewer("map")
    viewer.add("RobotModel", "/robot_description")
    viewer.add("Marker", "/visualization_marker")

    def sees(part: str) -> bool:
        return any(part in name for name in viewer.scene.objects())

    advance_until(student, lambda: sees("Marker/basic_shapes/0"), "the red cube")
    advance_until(student, lambda: sees("RobotModel/links/ur10wrist_3_link"), "the robot")
    assert not sees("Marker/(none)")  # it paints while the arm moves
    arm = student.add_publisher(student.add_node("sweep", "/"), ARM, type_name(JointTrajectory), Qos())
    due, angles = wall.monotonic(), cycle((0.2, -0.2))

    def painted() -> bool:
        nonlocal due
        # The way may not be there yet, and a process that is stopped for the whole movement, on a
        # busy machine, paints no line. It paints only while the arm moves, to another goal each time.
        if wall.monotonic() >= due:
            student.publish(arm, lifted(next(angles)))
            due = wall.monotonic() + 2.0  # [s]
        return any(re.search(r"Marker/\(none\)/\d+/lines", name) for name in viewer.scene.objects())

    advance_until(student, painted, "paint")
    viewer.close()
    student.close()
