"""The frozen outcomes of probes and small programs, against the real rclpy itself."""

import os
from pathlib import Path

import pytest

from tests.real_ros.renew import frozen_outcomes, outcomes_after_interrupt, outcomes_of_probes

HERE = Path(__file__).parent
PYTHON = os.environ.get("REAL_ROS_PYTHON", "")
FILES = sorted(file.stem for file in (HERE / "probes").glob("*.py") if file.stem != "probing")
PROGRAMS = sorted(file.stem for file in (HERE / "programs").glob("*.py"))
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not PYTHON, reason="REAL_ROS_PYTHON names no Python with the real rclpy"),
]


@pytest.mark.parametrize("file", FILES)
def test_real_rclpy_gives_the_frozen_outcomes(file: str) -> None:
    assert outcomes_of_probes(PYTHON, HERE / "probes" / f"{file}.py") == frozen_outcomes(file)


def test_real_rclpy_ends_programs_as_in_the_frozen_outcomes() -> None:
    frozen = frozen_outcomes("programs")
    different: dict[str, object] = dict.fromkeys(PROGRAMS)
    # How far a program is when the interrupt arrives varies, so the real rclpy gets three runs.
    for _ in range(3):
        outcomes = outcomes_after_interrupt(PYTHON, (HERE / "programs" / f"{name}.py" for name in different))
        different = {name: outcomes[name] for name in different if outcomes[name] != frozen[name]}
    assert different == {}
