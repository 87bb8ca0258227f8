"""Actions between two kits that are linked by DDS, each in a separate process."""

import subprocess
from pathlib import Path

import pytest

from course_lib.real.process import free_domain
from tests.patience import PATIENCE
from tests.processes import Program
from tests.ros.dds.actions import (
    CLIENT,
    DYING_SERVER,
    ENDED,
    ENDS,
    EXPECTED,
    FIXED_SEED,
    SERVER,
    WAITING_CLIENT,
    in_kit,
)


# Without a seed no datagram is lost, with a seed 30 % in each direction.
@pytest.mark.slow
@pytest.mark.parametrize("seed", [None, 1])
def test_goals_feedback_and_results_arrive_once_and_in_order(tmp_path: Path, seed: int | None) -> None:
    (tmp_path / "server.py").write_text(SERVER)
    (tmp_path / "client.py").write_text(CLIENT)
    domain = "--domain", str(free_domain())
    server = in_kit(tmp_path / "server.py", *domain, seed=seed)
    with Program(server, env=FIXED_SEED, stdout=subprocess.PIPE) as robot:
        try:
            client = in_kit(tmp_path / "client.py", *domain, seed=seed)
            done = subprocess.run(
                client, capture_output=True, text=True, timeout=2 * PATIENCE, env=FIXED_SEED
            )
        finally:
            robot.terminate()
            robot.communicate(timeout=PATIENCE)
    assert done.stdout == EXPECTED, done.stderr


# As in rclpy, the future of a result never completes; the client sees that the server is gone.
@pytest.mark.slow
@pytest.mark.parametrize("end", ENDS)
def test_goal_whose_server_dies_has_no_result_and_the_client_notices(tmp_path: Path, end: str) -> None:
    (tmp_path / "server.py").write_text(DYING_SERVER.replace("END", ENDS[end]))
    (tmp_path / "client.py").write_text(WAITING_CLIENT)
    domain = "--domain", str(free_domain())
    server = in_kit(tmp_path / "server.py", *domain)
    with Program(server, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as robot:
        client = in_kit(tmp_path / "client.py", *domain)
        done = subprocess.run(client, capture_output=True, text=True, timeout=PATIENCE)
        robot.communicate(timeout=PATIENCE)
    assert done.stdout == ENDED, done.stderr
