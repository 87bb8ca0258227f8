"""Students' mistakes: the kit's errors equal the frozen errors of the real rclpy."""

import json
from pathlib import Path

from tests.real_ros import differences
from tests.real_ros.mistakes import PROGRAMS, without_modules
from tests.ros.rclpy.test_mistakes import MISTAKES

FROZEN = json.loads((Path(__file__).parent / "frozen" / "mistakes.json").read_text("utf-8"))
ROWS = {program: text for program, text, _ in MISTAKES if program in PROGRAMS}


def test_frozen_mistakes_agree_with_the_table() -> None:
    assert FROZEN["rclpy"] == "7.1.6"
    assert set(FROZEN["outcomes"]) == set(PROGRAMS), "renew them: python tests/real_ros/renew.py mistakes"
    assert set(differences.MISTAKES) <= set(PROGRAMS)


def test_mistake_raises_the_error_of_the_real_rclpy() -> None:
    # tests/ros/rclpy/test_mistakes.py tests that the kit has these texts.
    outcomes = FROZEN["outcomes"]
    different = {
        program: outcomes[program]
        for program, text in ROWS.items()
        if without_modules(text).strip() not in outcomes[program]
    }
    expected = ROWS.keys() & differences.MISTAKES
    assert different.keys() - expected == set(), different
    assert expected - different.keys() == set(), "they agree now: remove them from differences.py"
