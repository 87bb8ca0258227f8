"""Actions of a program on the real rclpy, called by a student through `course router`."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from course_lib.gateway.gateway import load_users
from course_lib.real.environment import find_environment
from course_lib.real.process import RealProcesses
from tests.gateway.conftest import ROSTER, wait_for
from tests.patience import PATIENCE
from tests.ports import free_port
from tests.processes import Program
from tests.ros.dds.actions import CLIENT, EXPECTED, SERVER

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not os.environ.get("REAL_ROS_PYTHON"), reason="REAL_ROS_PYTHON names no Python with the real rclpy"
    ),
]


def test_student_sends_goals_to_the_real_robot_through_the_router(tmp_path: Path) -> None:
    server, client, log = tmp_path / "server.py", tmp_path / "client.py", tmp_path / "router.txt"
    server.write_text(SERVER)
    client.write_text(CLIENT)
    (tmp_path / "roster.csv").write_text(ROSTER)
    place = f"tcp/127.0.0.1:{free_port()}"
    programs = RealProcesses(find_environment(), tmp_path, [server], print)
    kit, domain = [sys.executable, "-m", "course_lib"], ["--domain", str(programs.domain)]
    options = ["--robot", "dds/127.0.0.1", "--listen", place, "--call", "/fib", "--students", "roster.csv"]
    programs.start(server)
    try:
        with log.open("wb") as out:
            router = Program([*kit, "router", *options, *domain], cwd=tmp_path, stdout=out, stderr=out)
        wait_for(lambda: "The robot is linked." in log.read_text(), "the robot is linked")
        ann = load_users(tmp_path / "course_router", None, "", place)[1]
        link = ["--robot", ann.address(place), "--call", "/fib", *domain]
        command = [*kit, "run", str(client), *link]
        process = subprocess.run(command, capture_output=True, text=True, timeout=3 * PATIENCE)
        router.send_signal(signal.SIGINT)
        assert router.wait(PATIENCE) == 0, log.read_text()
    finally:
        programs.end(lambda: None)
    assert process.stdout == EXPECTED, process.stderr + log.read_text()
