"""`course router` in front of a robot that runs the real rclpy over DDS, with nothing set on the robot."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from course_lib.gateway.gateway import GatewayUser, load_users
from course_lib.real.process import free_domain
from tests.gateway.conftest import ROSTER, wait_for
from tests.patience import PATIENCE
from tests.ports import free_port
from tests.processes import LIMIT_OF_A_SERVER, Program
from tests.ros.dds.test_real_rclpy import PYTHON, ROBOT, RealRobot

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not PYTHON, reason="REAL_ROS_PYTHON names no Python with the real rclpy"),
]


class Lab:
    """A real robot, the router in front of it, and a student."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        program = folder / "robot.py"
        program.write_text(ROBOT)
        self.domain = free_domain()
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        environment |= {"ROS_DOMAIN_ID": str(self.domain), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
        pipe = subprocess.PIPE
        started = Program([PYTHON, str(program)], limit=LIMIT_OF_A_SERVER, stdout=pipe, env=environment)
        self.robot = RealRobot(started, self.domain)
        self.robot.line("up")
        self._place = f"tcp/127.0.0.1:{free_port()}"
        (folder / "roster.csv").write_text(ROSTER)
        words = ["--robot", "dds/127.0.0.1", "--domain", str(self.domain), "--listen", self._place]
        words += ["--send", "/cmd_vel", "--call", "/reset", "--call", "/lab/robot/get_parameters"]
        words += ["--students", "roster.csv", "--driver", "1234"]
        self.log = folder / "router.txt"
        with self.log.open("wb") as out:
            command = [sys.executable, "-m", "course_lib", "router", *words]
            self.router = Program(command, limit=LIMIT_OF_A_SERVER, cwd=folder, stdout=out, stderr=out)
        wait_for(lambda: "The robot is linked." in self.log.read_text(), "the robot is linked")
        users = load_users(folder / "course_router", None, "", self._place)
        self.ann, self.bob = users[1:]

    def ros2(self, user: GatewayUser, *words: str, send: str = "", call: str = "") -> str:
        """Return the output of `course ros2` in a student's kit."""
        options = ["--robot", user.address(self._place), "--domain", str(self.domain)]
        options += ["--send", send] * bool(send) + ["--call", call] * bool(call)
        command = [sys.executable, "-m", "course_lib", "ros2", *options, *words]
        process = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
        assert process.returncode == 0, process.stdout + process.stderr
        return process.stdout

    def close(self) -> None:
        """End the router and the robot as Ctrl+C does."""
        self.router.send_signal(signal.SIGINT)
        assert self.router.wait(PATIENCE) == 0, self.log.read_text()
        self.robot.process.send_signal(signal.SIGINT)
        self.robot.process.communicate(timeout=PATIENCE)


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    one = Lab(tmp_path_factory.mktemp("lab"))
    yield one
    one.close()


def test_student_discovers_nodes_and_topics_of_the_real_robot(lab: Lab) -> None:
    assert {"/gateway", "/lab/robot"} <= set(lab.ros2(lab.bob, "node", "list").split())
    lines = lab.ros2(lab.bob, "topic", "list", "-t").splitlines()
    assert {"/lab/scan [sensor_msgs/msg/LaserScan]", "/cmd_vel [geometry_msgs/msg/Twist]"} <= set(lines)
    assert "Reliability: BEST_EFFORT" in lab.ros2(lab.bob, "topic", "info", "-v", "/lab/scan")


def test_messages_of_the_real_robot_reach_a_student(lab: Lab) -> None:
    assert lab.ros2(lab.bob, "topic", "echo", "--once", "/robot_description") == "data: <robot/>\n---\n"
    ranges = lab.ros2(lab.bob, "topic", "echo", "--once", "--field", "ranges", "/lab/scan")
    assert ranges.split() == ["array('f',", "[1.0,", "2.0])", "---"]
    assert lab.ros2(lab.bob, "topic", "echo", "--once", "--field", "width", "/lab/image").split()[0] == "640"


def test_services_and_parameters_of_the_real_robot_answer_a_student(lab: Lab) -> None:
    request = ("service", "call", "/reset", "std_srvs/srv/SetBool", "{data: true}")
    reply = lab.ros2(lab.bob, *request, call="/reset")
    assert "SetBool_Response(success=True, message='done')" in reply
    value = lab.ros2(lab.bob, "param", "get", "/lab/robot", "speed", call="/lab/robot/get_parameters")
    assert value == "Double value is: 0.5\n"


def test_only_the_driver_moves_the_real_robot_and_it_stops_afterwards(lab: Lab) -> None:
    twist = ("geometry_msgs/msg/Twist", "{linear: {x: %s}}")
    publish = ("topic", "pub", "--times", "3", "/cmd_vel", twist[0])
    lab.ros2(lab.bob, *publish, twist[1] % "0.9", send="/cmd_vel")
    lab.ros2(lab.ann, *publish, twist[1] % "0.2", send="/cmd_vel")
    assert lab.robot.line("cmd_vel") == "cmd_vel 0.2"
    while (line := lab.robot.line("cmd_vel")) == "cmd_vel 0.2":
        pass
    assert line == "cmd_vel 0.0"


def test_real_robot_discovers_the_gateway(lab: Lab) -> None:
    assert "'gateway'" in lab.robot.line("nodes")
