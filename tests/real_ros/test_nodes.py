"""The nodes of lessons, exercises and solutions do the same in the kit and under the real rclpy."""

import json
from functools import cache
from pathlib import Path

import pytest

from tests.python_messages import without_python_version
from tests.real_ros import differences
from tests.real_ros.nodes import MISSING, Outcomes, outcomes_in_kit, programs

FROZEN = json.loads((Path(__file__).parent / "frozen" / "nodes.json").read_text("utf-8"))
_in_kit = cache(outcomes_in_kit)


def test_frozen_outcomes_are_from_the_nodes_of_the_course() -> None:
    assert FROZEN["rclpy"] == "7.1.6"
    renew = "run tests/real_ros/renew.py nodes: a node of the course is new, changed its name or is gone"
    assert set(FROZEN["outcomes"]) == set(programs()), renew
    assert set(differences.NODES) <= set(programs())


def test_nodes_of_all_weeks_are_compared() -> None:
    assert {name[:6] for name in programs()} >= {f"week0{week}" for week in range(9)}
    assert len(programs()) > 100
    assert not any(f"import {name}" in text for text in programs().values() for name in MISSING)


def test_outcomes_have_messages_inputs_and_errors() -> None:
    outcomes: Outcomes = FROZEN["outcomes"]
    assert sum(bool(one["topics"]) for one in outcomes.values()) > 70
    assert any("NotImplementedError" in one["error"] for one in outcomes.values())
    assert sum(bool(one["lines"]) for one in outcomes.values()) > 3


@pytest.mark.parametrize("name", FROZEN["outcomes"])
def test_node_of_the_course_has_the_outcome_of_the_real_rclpy(name: str) -> None:
    expected, actual = FROZEN["outcomes"][name], _in_kit()[name]
    for outcome in (expected, actual):
        outcome["error"] = without_python_version(outcome["error"])
    if name not in differences.NODES:
        # After a change of the node itself: run tests/real_ros/renew.py nodes.
        assert actual == expected
        return
    assert actual != expected, f"it agrees by now: take it out of the row {differences.NODES[name]!r}"
    if expected["topics"]:
        assert differences.without_values(actual) == differences.without_values(expected)
