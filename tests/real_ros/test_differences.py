"""docs/simulated.md is the only list of differences from the real rclpy; tests contain no others."""

import re
from itertools import chain
from pathlib import Path

import pytest

from tests.real_ros import differences
from tests.real_ros.test_outcomes import frozen_outcomes

PAGE = (Path(__file__).parents[2] / "docs" / "simulated.md").read_text("utf-8")
SHOWN_BY = {
    row[0].strip(): row[-1]
    for row in (line.strip("|").split(" | ") for line in PAGE.splitlines() if line.startswith("| "))
    if "`test_" in row[-1]
}
PROBES = [(file, name) for file, probes in differences.PROBES.items() for name in probes]
BY_PROBES = "test_probe_has_the_outcome_of_the_real_rclpy"


def _tests_of(row: str) -> list[str]:
    assert row in SHOWN_BY, f"docs/simulated.md has no row {row!r}"
    return re.findall(r"`(test_\w+)`", SHOWN_BY[row])


@pytest.mark.parametrize(("file", "name"), PROBES)
def test_each_accepted_difference_has_a_row_that_lists_its_probes(file: str, name: str) -> None:
    assert BY_PROBES in _tests_of(differences.PROBES[file][name].row)


def test_each_row_of_the_probes_has_a_difference_or_an_agreement() -> None:
    listed_rows = {row for row in SHOWN_BY if BY_PROBES in _tests_of(row)}
    different = {
        difference.row
        for difference in chain.from_iterable(probes.values() for probes in differences.PROBES.values())
    }
    assert listed_rows == different | set(differences.AGREEMENTS)


@pytest.mark.parametrize("row", differences.AGREEMENTS)
def test_each_row_of_an_agreement_has_a_probe_that_agrees(row: str) -> None:
    file, name = differences.AGREEMENTS[row]
    assert name in frozen_outcomes(file)
    assert name not in differences.PROBES.get(file, {})


def test_differences_of_programs_have_rows() -> None:
    test_of_programs = "test_end_of_a_run_has_the_same_effect_on_a_program_as_ctrl_c"
    assert test_of_programs in _tests_of(differences.END_OF_A_RUN)
    rows = (*differences.OTHER_VALUES.values(), *differences.MISTAKES.values())
    for row in (*rows, *differences.SIGNATURES.values(), differences.PARAMETERS_OF_LAUNCH):
        assert _tests_of(row)
    for row in differences.NODES.values():
        assert "test_node_of_the_course_has_the_outcome_of_the_real_rclpy" in _tests_of(row)


def test_difference_without_a_row_is_reported() -> None:
    with pytest.raises(AssertionError, match="has no row 'Something else'"):
        _tests_of("Something else")
