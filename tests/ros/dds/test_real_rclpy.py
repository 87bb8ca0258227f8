"""The DDS link to the real rclpy, in a separate process and on loopback."""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from course_lib.real.process import free_domain
from tests.patience import PATIENCE
from tests.processes import LIMIT_OF_A_SERVER, Program
from tests.ros.dds.attack import ATTACK, ATTEMPTS, VICTIM

PYTHON = os.environ.get("REAL_ROS_PYTHON", "")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not PYTHON, reason="REAL_ROS_PYTHON names no Python with the real rclpy"),
]
ROBOT = """
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import Image, LaserScan
from std_msgs.msg import String
from std_srvs.srv import SetBool

rclpy.init()
node = Node("robot", namespace="/lab")
node.declare_parameter("speed", 0.5)
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
description = node.create_publisher(String, "/robot_description", latched)
description.publish(String(data="<robot/>"))
scans = node.create_publisher(LaserScan, "scan", qos_profile_sensor_data)
images = node.create_publisher(Image, "image", 2)
pixels = bytes(range(256)) * 1200


def on_timer():
    scans.publish(LaserScan(ranges=[1.0, 2.0]))
    images.publish(Image(height=480, width=640, step=640, encoding="mono8", data=pixels))


def on_request(request, response):
    response.success, response.message = request.data, "done"
    return response


node.create_timer(0.1, on_timer)
node.create_service(SetBool, "/reset", on_request)
node.create_subscription(Twist, "/cmd_vel", lambda m: print("cmd_vel", m.linear.x, flush=True), 10)
node.create_timer(0.5, lambda: print("nodes", sorted(node.get_node_names()), flush=True))


def print_gid():
    (info,) = node.get_publishers_info_by_topic("/lab/scan")
    print("scan", ".".join(f"{byte:02x}" for byte in info.endpoint_gid), flush=True)


node.create_timer(0.5, print_gid)
print("up", flush=True)
rclpy.spin(node)
"""

RELIABLE_SCANS = """
import rclpy
from sensor_msgs.msg import LaserScan

rclpy.init()
node = rclpy.create_node("reliable")
node.create_subscription(LaserScan, "/lab/scan", lambda scan: print("received"), 10)
rclpy.spin(node)
"""


@dataclass
class RealRobot:
    """A program on the real rclpy."""

    process: Program
    domain: int

    def line(self, start: str) -> str:
        """Return the next line of its output with a start."""
        assert self.process.stdout is not None
        deadline = time.monotonic() + PATIENCE
        # The robot prints a line every half second, so the loop ends.
        for line in self.process.stdout:
            if line.startswith(start):
                return line.strip()
            assert time.monotonic() < deadline, f"the robot printed no {start!r}"
        raise AssertionError(f"the robot ended without {start!r}")

    def ros2(self, *words: str, send: str = "", call: tuple[str, ...] = ()) -> str:
        """Return the output of `course ros2` over the link."""
        options = ["--robot", "dds/127.0.0.1", "--domain", str(self.domain)]
        options += ["--send", send] * bool(send) + [word for name in call for word in ("--call", name)]
        command = [sys.executable, "-m", "course_lib", "ros2", *options, *words]
        return subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True).stdout


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RealRobot]:
    with real_robot(ROBOT, tmp_path_factory.mktemp("robot")) as started:
        yield started


@contextmanager
def real_robot(text: str, folder: Path) -> Iterator[RealRobot]:
    """Run a program on the real rclpy in a separate domain, until the end of a `with` block."""
    program = folder / "robot.py"
    program.write_text(text)
    domain = free_domain()
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment |= {"ROS_DOMAIN_ID": str(domain), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    command = [PYTHON, str(program)]
    process = Program(command, limit=LIMIT_OF_A_SERVER, stdout=subprocess.PIPE, env=environment)
    started = RealRobot(process, domain)
    started.line("up")
    yield started
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=PATIENCE)


def test_nodes_and_topics_of_the_real_rclpy_are_listed(robot: RealRobot) -> None:
    assert robot.ros2("node", "list") == "/lab/robot\n"
    listed = robot.ros2("topic", "list", "-t").splitlines()
    assert {"/lab/scan [sensor_msgs/msg/LaserScan]", "/cmd_vel [geometry_msgs/msg/Twist]"} <= set(listed)
    info = robot.ros2("topic", "info", "-v", "/lab/scan")
    assert "Reliability: BEST_EFFORT\n  History (Depth): UNKNOWN\n" in info
    assert "Node namespace: /lab" in info
    (gid,) = re.findall(r"^GID: (.+)$", info, re.MULTILINE)
    assert robot.line("scan") == f"scan {gid}"
    assert "middleware name    : DDS (course_lib)\n" in robot.ros2("doctor", "--report")


def test_messages_of_the_real_rclpy_arrive(robot: RealRobot) -> None:
    assert robot.ros2("topic", "echo", "--once", "/robot_description") == "data: <robot/>\n---\n"
    ranges = robot.ros2("topic", "echo", "--once", "--field", "ranges", "/lab/scan")
    assert ranges.split() == ["array('f',", "[1.0,", "2.0])", "---"]
    assert robot.ros2("topic", "echo", "--once", "--field", "width", "/lab/image").split() == ["640", "---"]


def test_services_and_parameters_of_the_real_rclpy_respond(robot: RealRobot) -> None:
    reply = robot.ros2("service", "call", "/reset", "std_srvs/srv/SetBool", "{data: true}", call=("/reset",))
    assert "SetBool_Response(success=True, message='done')" in reply
    services = tuple(f"/lab/robot/{name}" for name in ("get_parameters", "list_parameters"))
    assert robot.ros2("param", "get", "/lab/robot", "speed", call=services) == "Double value is: 0.5\n"


def test_call_that_is_not_allowed_ends_the_command_with_the_reason(robot: RealRobot) -> None:
    link = ["--robot", "dds/127.0.0.1", "--domain", str(robot.domain)]
    for words, name in (
        (("service", "call", "/reset", "std_srvs/srv/SetBool", "{data: true}"), "/reset"),
        (("param", "get", "/lab/robot", "speed"), "/lab/robot/get_parameters"),
    ):
        command = [sys.executable, "-m", "course_lib", "ros2", *link, *words]
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=False)
        assert done.returncode == 1
        assert (
            f"error: {name} was not called, because the link to the robot does not allow it." in done.stderr
        )
        assert f"To send them, connect with --call {name}" in done.stderr


def test_incompatible_qos_is_reported_with_the_policy(robot: RealRobot, tmp_path: Path) -> None:
    program = tmp_path / "reliable.py"
    program.write_text(RELIABLE_SCANS)
    link = ["--robot", "dds/127.0.0.1", "--domain", str(robot.domain)]
    command = [sys.executable, "-m", "course_lib", "run", str(program), "--seconds", "2", *link]
    done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
    line = (
        "/lab/scan: the publisher of /lab/robot and the subscription of /reliable have "
        "incompatible QoS (RELIABILITY). DDS does not connect them"
    )
    assert done.stderr.count(line) == 1
    assert "received" not in done.stdout


def test_real_rclpy_receives_the_command_and_then_a_stop(robot: RealRobot) -> None:
    robot.ros2(
        "topic", "pub", "--once", "/cmd_vel", "geometry_msgs/msg/Twist", "{linear: {x: 0.5}}", send="/cmd_vel"
    )
    assert robot.line("cmd_vel") == "cmd_vel 0.5"
    assert robot.line("cmd_vel") == "cmd_vel 0.0"


def test_real_rclpy_lists_the_node_of_the_kit(robot: RealRobot, tmp_path: Path) -> None:
    program = tmp_path / "listener.py"
    program.write_text("import rclpy\nrclpy.init()\nrclpy.spin(rclpy.create_node('student'))\n")
    link = ["--robot", "dds/127.0.0.1", "--domain", str(robot.domain)]
    command = [sys.executable, "-m", "course_lib", "run", str(program), *link]
    with Program(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as kit:
        try:
            while "student" not in robot.line("nodes"):
                assert kit.poll() is None
        finally:
            kit.send_signal(signal.SIGINT)
            kit.wait(PATIENCE)


def test_thousand_attempts_to_send_unpermitted_messages_do_not_reach_the_network(tmp_path: Path) -> None:
    attack = tmp_path / "attack.py"
    attack.write_text(ATTACK)
    with real_robot(VICTIM, tmp_path) as victim:
        link = ["--robot", "dds/127.0.0.1", "--domain", str(victim.domain), "--send", "/allowed"]
        command = [sys.executable, "-m", "course_lib", "run", str(attack), *link]
        with Program(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as kit:
            assert victim.process.stdout is not None
            lines: list[str] = []
            # The program's last message is permitted and contains the number of attempts.
            for line in victim.process.stdout:
                lines.append(line)
                if line.startswith("allowed ") and "attempts" in line:
                    break
            kit.send_signal(signal.SIGINT)
            kit.communicate(timeout=PATIENCE)
    assert int(lines[-1].split()[1]) >= ATTEMPTS
    assert [line for line in lines if line.startswith("hit")] == []


RAW_ROBOT = """
import rclpy
from rclpy.node import Node
from rclpy.serialization import serialize_message
from std_msgs.msg import String

rclpy.init()
node = Node("robot")
publisher = node.create_publisher(String, "/out", 10)
node.create_subscription(String, "/in", lambda data: print("raw", data, flush=True), 10, raw=True)


def on_timer():
    publisher.publish(String(data="ab"))
    publisher.publish(serialize_message(String(data="abc")))


node.create_timer(0.2, on_timer)
print("up", flush=True)
rclpy.spin(node)
"""
RAW_PROGRAM = """
import rclpy
from rclpy.serialization import serialize_message
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("kit")
publisher = node.create_publisher(String, "/in", 10)
seen = set()
node.create_subscription(String, "/out", lambda data: seen.add(data), 10, raw=True)
node.create_timer(0.2, lambda: publisher.publish(serialize_message(String(data="ab"))))
while len(seen) < 2 or publisher.get_subscription_count() == 0:
    rclpy.spin_once(node, timeout_sec=0.1)
for _ in range(10):
    rclpy.spin_once(node, timeout_sec=0.2)
print(*sorted(seen), sep="\\n")
"""
AB = r"b'\x00\x01\x00\x00\x03\x00\x00\x00ab\x00\x00'"
ABC = r"b'\x00\x01\x00\x00\x04\x00\x00\x00abc\x00'"


def test_raw_subscription_and_bytes_between_processes(tmp_path: Path) -> None:
    """On the way to another process Fast DDS pads a message to a multiple of 4 bytes."""
    program = tmp_path / "program.py"
    program.write_text(RAW_PROGRAM)
    with real_robot(RAW_ROBOT, tmp_path) as robot:
        command = [sys.executable, "-m", "course_lib", "run", str(program), "--seconds", str(PATIENCE)]
        command += ["--robot", "dds/127.0.0.1", "--domain", str(robot.domain), "--send", "/in"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE, check=True)
        assert done.stdout.splitlines() == [AB, ABC]
        assert robot.line("raw") == f"raw {AB}"
