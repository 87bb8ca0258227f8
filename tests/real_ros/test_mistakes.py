"""Students' mistakes: the kit's errors equal the frozen errors of the real rclpy."""

import json
from pathlib import Path

import pytest

from tests.real_ros import differences
from tests.real_ros.mistakes import PROGRAMS, without_modules
from tests.ros.rclpy.test_mistakes import MISTAKES

FROZEN = json.loads((Path(__file__).parent / "frozen" / "mistakes.json").read_text("utf-8"))
ROWS = {program: text for program, text, _ in MISTAKES if program in PROGRAMS}


def test_frozen_mistakes_agree_with_the_table() -> None:
    assert FROZEN["rclpy"] == "7.1.6"
    assert set(FROZEN["outcomes"]) == set(PROGRAMS), "renew them: python tests/real_ros/renew.py mistakes"
    assert set(differences.MISTAKES) <= set(PROGRAMS)


@pytest.mark.parametrize("program", ROWS)
def test_mistake_raises_the_error_of_the_real_rclpy(program: str) -> None:
    # tests/ros/rclpy/test_mistakes.py tests that the kit has this text.
    is_equal = without_modules(ROWS[program]).strip() in FROZEN["outcomes"][program]
    assert is_equal != (program in differences.MISTAKES), FROZEN["outcomes"][program]
