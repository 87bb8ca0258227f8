"""Actions between the kit, linked by DDS, and a program on the real rclpy, in both directions."""

import os
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from course_lib.real.environment import find_environment
from course_lib.real.process import RealProcesses
from tests.patience import PATIENCE
from tests.processes import Program
from tests.ros.dds.actions import CLIENT, EXPECTED, FIXED_SEED, SERVER, in_kit

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not os.environ.get("REAL_ROS_PYTHON"), reason="REAL_ROS_PYTHON names no Python with the real rclpy"
    ),
]


@pytest.fixture
def programs(tmp_path: Path) -> Iterator[RealProcesses]:
    for name, text in {"server": SERVER, "client": CLIENT}.items():
        (tmp_path / f"{name}.py").write_text(text)
    started = RealProcesses(find_environment(), tmp_path, [], print)
    yield started
    started.end(lambda: None)


# Without a seed no datagram is lost, with a seed 30 % in each direction.
SEEDS = [None, 1]


@pytest.mark.parametrize("seed", SEEDS)
def test_kit_action_client_reaches_a_server_on_the_real_rclpy(
    programs: RealProcesses, tmp_path: Path, seed: int | None
) -> None:
    programs.start(tmp_path / "server.py")
    command = in_kit(tmp_path / "client.py", "--domain", str(programs.domain), seed=seed, peer="real")
    process = subprocess.run(command, capture_output=True, text=True, timeout=3 * PATIENCE, env=FIXED_SEED)
    assert process.stdout == EXPECTED, process.stderr


@pytest.mark.parametrize("seed", SEEDS)
def test_kit_action_server_serves_a_client_on_the_real_rclpy(
    programs: RealProcesses, tmp_path: Path, seed: int | None
) -> None:
    out = tmp_path / "out.txt"
    command = in_kit(tmp_path / "server.py", "--domain", str(programs.domain), seed=seed, peer="real")
    with Program(command, env=FIXED_SEED) as kit:
        try:
            with out.open("w") as stream:
                programs.start(tmp_path / "client.py", streams=(stream, None))
                programs.processes[0].wait(3 * PATIENCE)
        finally:
            kit.terminate()
            kit.wait(PATIENCE)
    assert out.read_text() == EXPECTED
