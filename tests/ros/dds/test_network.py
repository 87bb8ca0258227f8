"""The real rclpy and the kit on two computers: network namespaces joined by a veth pair."""

import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.patience import PATIENCE
from tests.processes import LIMIT_OF_A_SERVER, Program
from tests.ros.dds.test_real_rclpy import PYTHON, ROBOT, RealRobot


def ip(*words: str) -> bool:
    """Run a command of iproute2; return whether it worked."""
    try:
        return subprocess.run(["ip", *words], capture_output=True, timeout=10, check=False).returncode == 0
    except FileNotFoundError:
        return False


def reason_against() -> str:
    """Return why namespaces cannot be made here, or ""."""
    name = f"probe{os.getpid()}"
    if not ip("netns", "add", name):
        return "network namespaces need root and iproute2"
    is_linked = ip("-n", name, "link", "add", "one", "type", "veth", "peer", "name", "two")
    ip("netns", "delete", name)
    return "" if is_linked else "this kernel has no veth pairs"


pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not PYTHON, reason="REAL_ROS_PYTHON names no Python with the real rclpy"),
    pytest.mark.skipif(bool(PYTHON) and bool(reason_against()), reason="no network namespaces here"),
]
ROBOTS_ADDRESS, KITS_ADDRESS = "10.77.0.1", "10.77.0.2"
DRIVER = """
import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("driver")
publisher = node.create_publisher(Twist, "/cmd_vel", 10)
command = Twist()
command.linear.x = 0.5
node.create_timer(0.1, lambda: publisher.publish(command))
rclpy.spin(node)
"""


@dataclass
class RemoteRobot(RealRobot):
    """A robot in its own network namespace, and the namespace of the kit."""

    robots_namespace: str
    kits_namespace: str

    def kit(self, *words: str) -> Program:
        """Start a command of the kit in its namespace."""
        command, *rest = words
        link = ["--robot", f"dds/{ROBOTS_ADDRESS}", "--domain", str(self.domain)]
        line = ["ip", "netns", "exec", self.kits_namespace, sys.executable, "-m", "course_lib", command]
        pipe = subprocess.PIPE
        return Program([*line, *link, *rest], stdout=pipe, stderr=pipe)

    def ros2(self, *words: str, send: str = "", call: tuple[str, ...] = ()) -> str:
        """Return the output of `course ros2` over the link."""
        options = ["--send", send] * bool(send) + [word for name in call for word in ("--call", name)]
        process = self.kit("ros2", *options, *words)
        out, err = process.communicate(timeout=PATIENCE)
        assert process.returncode == 0, out + err
        return out

    def pull_cable(self, *, is_out: bool) -> None:
        """Disconnect the robot, or connect it again."""
        assert ip("-n", self.robots_namespace, "link", "set", "robot0", "down" if is_out else "up")


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RemoteRobot]:
    program: Path = tmp_path_factory.mktemp("robot") / "robot.py"
    program.write_text(ROBOT)
    number = os.getpid()
    robots, kits = f"robot{number}", f"kit{number}"
    for name in (robots, kits):
        assert ip("netns", "add", name)
        assert ip("-n", name, "link", "set", "lo", "up")
    try:
        # The first network of the robot, which the kit's computer does not reach.
        assert ip("-n", robots, "link", "add", "usb0", "type", "veth", "peer", "name", "base0")
        assert ip("-n", robots, "address", "add", "10.55.0.1/24", "dev", "usb0")
        for device in ("usb0", "base0"):
            assert ip("-n", robots, "link", "set", device, "up")
        assert ip(
            "-n", robots, "link", "add", "robot0", "type", "veth", "peer", "name", "kit0", "netns", kits
        )
        for name, device, address in ((robots, "robot0", ROBOTS_ADDRESS), (kits, "kit0", KITS_ADDRESS)):
            assert ip("-n", name, "address", "add", f"{address}/24", "dev", device)
            assert ip("-n", name, "link", "set", device, "up")
        domain = random.randint(1, 90)
        variables = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        variables |= {"ROS_DOMAIN_ID": str(domain)}
        command = ["ip", "netns", "exec", robots, PYTHON, str(program)]
        process = Program(command, limit=LIMIT_OF_A_SERVER, stdout=subprocess.PIPE, env=variables)
        started = RemoteRobot(process, domain, robots, kits)
        started.line("up")
        yield started
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=PATIENCE)
    finally:
        for name in (robots, kits):
            ip("netns", "delete", name)


def test_robot_on_another_computer_is_discovered_without_multicast(robot: RemoteRobot) -> None:
    assert robot.ros2("node", "list") == "/lab/robot\n"
    assert robot.ros2("topic", "echo", "--once", "/robot_description") == "data: <robot/>\n---\n"
    width = robot.ros2("topic", "echo", "--once", "--field", "width", "/lab/image")
    assert width.split() == ["640", "---"]
    reply = robot.ros2("service", "call", "/reset", "std_srvs/srv/SetBool", "{data: true}", call=("/reset",))
    assert "success=True" in reply


def test_missing_robot_on_another_computer_is_explained(robot: RemoteRobot) -> None:
    address = f"dds/{KITS_ADDRESS}"
    command = [sys.executable, "-m", "course_lib", "ros2", "--robot", address, "--domain", "99"]
    line = ["ip", "netns", "exec", robot.robots_namespace, *command, "node", "list"]
    done = subprocess.run(line, capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert f"Nothing comes from dds/{KITS_ADDRESS} in domain 99. The computer is there" in done.stderr


@contextmanager
def other_robot(robot: RemoteRobot, program: Path, variables: dict[str, str]) -> Iterator[RemoteRobot]:
    """Run one more program on the robot's computer, in the next domain, until the end of a `with` block."""
    domain = robot.domain + 1
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    environment |= {"ROS_DOMAIN_ID": str(domain), **variables}
    command = ["ip", "netns", "exec", robot.robots_namespace, PYTHON, str(program)]
    process = Program(command, stdout=subprocess.PIPE, env=environment)
    started = RemoteRobot(process, domain, robot.robots_namespace, robot.kits_namespace)
    started.line("up")
    try:
        yield started
    finally:
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=PATIENCE)


def nodes_and_errors(robot: RemoteRobot) -> tuple[str, str]:
    """Return the output of `ros2 node list` over the link."""
    listed = robot.kit("ros2", "node", "list")
    out, err = listed.communicate(timeout=PATIENCE)
    return out, err


@pytest.mark.parametrize(
    ("variables", "is_found"),
    [
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}, True),
        ({"ROS_LOCALHOST_ONLY": "1"}, True),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF"}, False),
        ({"ROS_DISCOVERY_SERVER": "127.0.0.1:11811"}, False),
    ],
    ids=["localhost", "localhost_only", "off", "discovery_server"],
)
def test_discovery_settings_of_the_robot_have_no_effect_or_are_reported(
    robot: RemoteRobot, tmp_path: Path, variables: dict[str, str], is_found: bool
) -> None:
    (tmp_path / "robot.py").write_text(ROBOT)
    with other_robot(robot, tmp_path / "robot.py", variables) as other:
        out, err = nodes_and_errors(other)
    assert (out == "/lab/robot\n") == is_found
    message = "A robot with a Fast DDS discovery server, or with ROS_AUTOMATIC_DISCOVERY_RANGE=OFF, does not"
    assert (message in err) != is_found


def test_error_explains_a_network_that_blocks_incoming_packets(robot: RemoteRobot) -> None:
    route = ("-n", robot.robots_namespace, "route")
    assert ip(*route, "add", "blackhole", KITS_ADDRESS)
    try:
        out, err = nodes_and_errors(robot)
    finally:
        assert ip(*route, "delete", "blackhole", KITS_ADDRESS)
    assert out == ""
    assert "Firewalls and WSL2 often let no UDP in." in err


# A killed process cannot send anything: then only the timeout of the robot's base stops it.
@pytest.mark.parametrize(
    ("number", "is_stopped"),
    [(signal.SIGINT, True), (signal.SIGTERM, True), (signal.SIGHUP, True), (signal.SIGKILL, False)],
)
def test_robot_receives_a_stop_when_its_driving_program_ends(
    robot: RemoteRobot, tmp_path: Path, number: signal.Signals, is_stopped: bool
) -> None:
    (tmp_path / "driver.py").write_text(DRIVER)
    kit = robot.kit("run", "--send", "/cmd_vel", str(tmp_path / "driver.py"))
    assert robot.line("cmd_vel") == "cmd_vel 0.5"
    kit.send_signal(number)
    kit.communicate(timeout=PATIENCE)
    # The robot prints its nodes twice a second: changes before the last two lines have arrived.
    assert robot.process.stdout is not None
    commands, nodes = ["cmd_vel 0.5"], 0
    for line in robot.process.stdout:
        commands += [line.strip()] * line.startswith("cmd_vel")
        nodes += line.startswith("nodes")
        if nodes == 4:
            break
    assert (commands[-1] == "cmd_vel 0.0") == is_stopped


def test_link_reconnects_after_a_cable_interruption(robot: RemoteRobot) -> None:
    kit = robot.kit("ros2", "topic", "hz", "/lab/scan")
    assert "average rate" in kit.read_line()
    robot.pull_cable(is_out=True)
    time.sleep(3.0)
    robot.pull_cable(is_out=False)
    began = time.monotonic()
    rates = [line for line in (kit.read_line() for _ in range(12)) if "average rate" in line]
    kit.send_signal(signal.SIGINT)
    kit.communicate(timeout=PATIENCE)
    assert rates
    assert time.monotonic() - began < PATIENCE


def test_link_follows_a_robot_whose_address_changes(robot: RemoteRobot) -> None:
    kit = robot.kit("ros2", "topic", "echo", "--field", "ranges", "/lab/scan")
    other = ROBOTS_ADDRESS.replace("77.0.1", "77.0.3")
    assert kit.stdout is not None
    assert kit.stderr is not None
    kit.stdout.readline()
    try:
        for change, address in (("add", other), ("del", ROBOTS_ADDRESS)):
            assert ip("-n", robot.robots_namespace, "address", change, f"{address}/24", "dev", "robot0")
        # Linux removes all addresses of a network with its first one, unless it promotes the next
        # one.
        ip("-n", robot.robots_namespace, "address", "add", f"{other}/24", "dev", "robot0")
        line = f"now has the address {other}"
        assert line in kit.stderr.readline()
        kit.send_signal(signal.SIGINT)
        kit.communicate(timeout=PATIENCE)
    finally:
        ip("-n", robot.robots_namespace, "address", "add", f"{ROBOTS_ADDRESS}/24", "dev", "robot0")
        ip("-n", robot.robots_namespace, "address", "del", f"{other}/24", "dev", "robot0")
        ip("-n", robot.robots_namespace, "address", "add", f"{ROBOTS_ADDRESS}/24", "dev", "robot0")
