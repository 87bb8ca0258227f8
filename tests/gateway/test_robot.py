"""The robot of the kit, and a kit that drives it through `course router`."""

import os
import re
import signal
import socket
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from course_lib import CourseError, start_robot
from course_lib.cli import app
from course_lib.gateway.robot import RobotProcess, SimulatedRobotAddress
from tests.gateway.conftest import ROSTER, wait_for
from tests.gateway.test_router import Started, course, says, started, users_in
from tests.patience import PATIENCE
from tests.ports import free_port
from tests.processes import Program

__all__ = ["started"]
DRIVER = """
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.publisher = self.create_publisher(Twist, "/cmd_vel", 10)
        self.create_timer(0.1, self.drive)

    def drive(self):
        command = Twist()
        command.linear.x = 0.3
        self.publisher.publish(command)


rclpy.init()
rclpy.spin(Driver())
"""


def x_of(folder: Path, router: str) -> float:
    """Return where the robot is, [m]."""
    words = ("topic", "echo", "--once", "/odom", "--field", "pose.pose.position.x")
    output = course(folder, "ros2", "--robot", router, *words)
    return float(output.splitlines()[0])


@pytest.mark.slow
def test_unmodified_node_drives_through_the_gateway_only_while_its_student_is_the_driver(
    tmp_path: Path, started: Started
) -> None:
    (tmp_path / "roster.csv").write_text(ROSTER)
    (tmp_path / "driver.py").write_text(DRIVER)
    robot, place = start_robot(), f"tcp/127.0.0.1:{free_port()}"
    words = ("--listen", place, "--send", "/cmd_vel", "--students", "roster.csv", "--driver", "1234")
    log = started("router", "--robot", robot.router, *words)
    says(log, "router is linked")
    _, ann, bob = users_in(tmp_path)

    def drive(address: str) -> str:
        return course(
            tmp_path, "run", "driver.py", "--robot", address, "--send", "/cmd_vel", "--seconds", "3"
        )

    drive(bob.address(place))
    assert x_of(tmp_path, robot.router) == 0.0

    def is_driven() -> bool:
        # On a busy machine the run may end before the way to the robot is there.
        drive(ann.address(place))
        return x_of(tmp_path, robot.router) > 0.1

    wait_for(is_driven, "the robot is driven")
    driven = x_of(tmp_path, robot.router)
    assert x_of(tmp_path, robot.router) == driven  # it stands
    output = course(tmp_path, "ros2", "--robot", bob.address(place), "topic", "list")
    assert {"/scan", "/odom", "/cmd_vel"} <= set(output.splitlines())
    assert "right" in drive(f"tcp/s1234:wrong@{place[4:]}")
    robot.stop()


@pytest.mark.slow
def test_unknown_robot_publishes_all_its_topics_on_the_network(tmp_path: Path, started: Started) -> None:
    place = f"tcp/127.0.0.1:{free_port()}"
    says(started("robot", "unknown", "--listen", place), "The robot is ready")

    def ros2(words: str, *options: str) -> str:
        return course(tmp_path, "ros2", "--robot", place, *options, *words.split())

    topics = set(ros2("topic list").splitlines())
    assert {"/robot/scan", "/robot/front_cam/image_raw", "/robot/odom", "/tf"} <= topics
    reset = "/robot/reset_odometry"
    assert "success=True" in ros2(f"service call {reset} std_srvs/srv/Trigger", "--call", reset)
    assert "/robot/gripper_cmd" in ros2("action list")


@pytest.mark.parametrize(("words", "domain"), [([], 7), (["--domain", "3"], 3)])
def test_domain_of_the_robot_is_the_environment_variable_without_the_option(
    monkeypatch: pytest.MonkeyPatch, words: list[str], domain: int
) -> None:
    domains = list[int]()

    def run(kind: str, address: SimulatedRobotAddress, write: object, *, with_parent: bool) -> int:
        domains.append(address.domain)
        return 0

    monkeypatch.setenv("ROS_DOMAIN_ID", "7")
    monkeypatch.setattr("course_lib.gateway.robot.robot", run)
    CliRunner().invoke(app, ["robot", *words])
    assert domains == [domain]


def test_nonexistent_robot_is_reported_in_one_line(tmp_path: Path) -> None:
    assert course(tmp_path, "robot", "flying").endswith(
        "There is no robot 'flying': start one of driving, unknown.\n"
    )


@pytest.mark.parametrize(
    ("command", "instead"), [("robot", "course robot --dds"), ("router", "A gateway needs")]
)
def test_command_without_zenoh_is_rejected_in_one_line(command: str, instead: str) -> None:
    script = "import sys; sys.modules['zenoh'] = None; from course_lib.__main__ import main; main()"
    process = subprocess.run(
        [sys.executable, "-c", script, command], capture_output=True, text=True, timeout=PATIENCE
    )
    assert process.stderr.startswith('error: A link over Zenoh needs two more packages: pip install "course')
    assert instead in process.stderr
    assert process.stderr.count("\n") == 1


def test_robot_over_zenoh_is_not_started_without_its_packages(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.ros.robot.connect.find_spec", lambda name: None)
    with pytest.raises(
        CourseError, match=r"^A link over Zenoh needs two more packages: .*start_robot\('dds'\)"
    ):
        start_robot()


def test_robot_process_that_does_not_end_is_killed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.gateway.robot.END_SECONDS", 0.1)
    command = [sys.executable, "-c", "import time; time.sleep(600)"]
    with Program(command, stdin=subprocess.PIPE) as process:
        RobotProcess(process, SimulatedRobotAddress("tcp/127.0.0.1:1"), "no software").stop()
        assert process.returncode == -signal.SIGKILL


def test_robot_that_is_not_ready_in_time_is_ended_and_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("course_lib.gateway.robot.START_SECONDS", 0.01)
    with pytest.raises(CourseError, match=r"The robot did not start within 0\.01 s: it printed nothing"):
        start_robot()


@pytest.mark.slow
def test_robot_ends_when_its_parent_process_is_killed(tmp_path: Path) -> None:
    script = "from course_lib import start_robot\nprint(start_robot().router, flush=True)\ninput()\n"
    process = Program([sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    port = int(process.read_line().rpartition(":")[2])
    process.send_signal(signal.SIGKILL)
    process.wait()

    def is_free() -> bool:
        with socket.socket() as one:
            return one.connect_ex(("127.0.0.1", port)) != 0

    wait_for(is_free, "the robot's router has gone")


@pytest.mark.slow
def test_robot_over_dds_uses_the_rclpy_of_the_kit_if_ros_is_not_installed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    monkeypatch.delenv("REAL_ROS_PYTHON", raising=False)
    robot = start_robot("dds")
    assert "in another process, on the kit's own rclpy." in repr(robot)
    words = ("--robot", robot.address, "--domain", str(robot.domain))
    output = course(tmp_path, "ros2", *words, "node", "list")
    assert output.splitlines() == ["/base", "/laser_scanner", "/robot_state_publisher"]
    # The laser is 0.25 m ahead of the middle of the room, whose walls are 3.9 m away.
    ranges = course(tmp_path, "ros2", *words, "topic", "echo", "--once", "/scan", "--field", "ranges")
    numbers = [float(one) for one in re.findall(r"\d+\.\d+", ranges)]
    assert numbers[0] == pytest.approx(3.9 + 0.25, abs=0.05)
    robot.stop()
    assert "has ended" in repr(robot)


@pytest.mark.slow
@pytest.mark.skipif("REAL_ROS_PYTHON" not in os.environ, reason="REAL_ROS_PYTHON names no real rclpy")
def test_robot_over_dds_runs_on_the_real_rclpy_and_stops_by_itself(tmp_path: Path) -> None:
    (tmp_path / "driver.py").write_text(DRIVER)
    robot = start_robot("dds")
    assert "on the real rclpy 7.1.6" in repr(robot)
    words = ("--robot", robot.address, "--domain", str(robot.domain))
    course(tmp_path, "run", "driver.py", *words, "--send", "/cmd_vel", "--seconds", "3")
    field = ("topic", "echo", "--once", "/odom", "--field")
    assert float(course(tmp_path, "ros2", *words, *field, "pose.pose.position.x").split()[0]) > 0.3
    assert float(course(tmp_path, "ros2", *words, *field, "twist.twist.linear.x").split()[0]) == 0.0
    robot.stop()


def test_start_robot_with_an_unknown_link_is_an_error() -> None:
    with pytest.raises(CourseError, match=r"start_robot\('usb'\): expected 'zenoh' or 'dds'"):
        start_robot("usb")  # type: ignore[arg-type]


def test_unknown_robot_on_real_ros_is_reported_in_one_line(tmp_path: Path) -> None:
    assert "--ros runs only 'driving'" in course(tmp_path, "robot", "unknown", "--ros")
