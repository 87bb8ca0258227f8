"""Whole programs at the end of a run, against frozen outcomes of the real rclpy after Ctrl+C."""

import json
from pathlib import Path
from typing import Any

import pytest

from tests.real_ros.differences import ENDS_AS_ASKED
from tests.real_ros.renew import outcome_of_program
from tests.warm import run_course

HERE = Path(__file__).parent
FROZEN: dict[str, Any] = json.loads((HERE / "frozen" / "programs.json").read_text("utf-8"))["outcomes"]


def _run(name: str) -> tuple[dict[str, object], str]:
    file = HERE / "programs" / f"{name}.py"
    process = run_course("run", "--seconds", "2", file)
    return outcome_of_program(process.stdout, process.stderr, process.returncode), process.stderr


def test_frozen_outcomes_are_from_these_programs() -> None:
    assert set(FROZEN) == {file.stem for file in (HERE / "programs").glob("*.py")}


@pytest.mark.parametrize("name", sorted(FROZEN))
def test_end_of_a_run_has_the_same_effect_on_a_program_as_ctrl_c(name: str) -> None:
    expected = FROZEN[name] | ({"exit": 0} if name in ENDS_AS_ASKED else {})
    assert _run(name)[0] == expected
    assert name not in ENDS_AS_ASKED or FROZEN[name]["exit"] != 0


@pytest.mark.slow
def test_publishing_after_the_end_of_a_run_hints_how_to_stop_a_robot() -> None:
    err = _run("stop_in_finally")[1]
    assert "hint: Ctrl+C and rclpy.shutdown() end publishing" in err
    assert "SignalHandlerOptions.NO" in err
