"""The kit's own robot, and a kit that drives it through `course router`."""

import signal
import socket
import subprocess
import sys
from pathlib import Path

from course_lib import start_robot
from tests.gateway.conftest import ROSTER, free_port, wait_for
from tests.gateway.test_router import Started, course, says, started, users_in

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
    said = course(folder, "ros2", "--robot", router, *words)
    return float(said.splitlines()[0])


def test_an_unchanged_node_drives_through_the_gateway_only_while_its_student_may(
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
    drive(ann.address(place))
    driven = x_of(tmp_path, robot.router)
    assert driven > 0.1
    assert x_of(tmp_path, robot.router) == driven  # it stands
    seen = course(tmp_path, "ros2", "--robot", bob.address(place), "topic", "list")
    assert {"/scan", "/odom", "/cmd_vel"} <= set(seen.splitlines())
    assert "right" in drive(f"tcp/s1234:wrong@{place[4:]}")
    robot.stop()


def test_all_of_the_unknown_robot_is_on_the_network(tmp_path: Path, started: Started) -> None:
    place = f"tcp/127.0.0.1:{free_port()}"
    says(started("robot", "unknown", "--listen", place), "The robot is ready")

    def ros2(words: str, *options: str) -> str:
        return course(tmp_path, "ros2", "--robot", place, *options, *words.split())

    topics = set(ros2("topic list").splitlines())
    assert {"/robot/scan", "/robot/front_cam/image_raw", "/robot/odom", "/tf"} <= topics
    reset = "/robot/reset_odometry"
    assert "success=True" in ros2(f"service call {reset} std_srvs/srv/Trigger", "--call", reset)
    assert "/robot/gripper_cmd" in ros2("action list")


def test_a_robot_that_does_not_exist_is_one_line(tmp_path: Path) -> None:
    assert course(tmp_path, "robot", "flying").endswith(
        "There is no robot 'flying': start one of driving, unknown.\n"
    )


def test_the_robot_ends_when_the_process_that_started_it_is_killed(tmp_path: Path) -> None:
    script = "from course_lib import start_robot\nprint(start_robot().router, flush=True)\ninput()\n"
    process = subprocess.Popen(
        [sys.executable, "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    port = int(process.stdout.readline().rpartition(":")[2])
    process.send_signal(signal.SIGKILL)
    process.wait()

    def is_free() -> bool:
        with socket.socket() as one:
            return one.connect_ex(("127.0.0.1", port)) != 0

    wait_for(is_free, "the robot's router has gone")
