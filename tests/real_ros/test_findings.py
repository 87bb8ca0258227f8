"""Each finding of the comparison with the real rclpy is shown by probes, tests or a row that exist."""

import re
from pathlib import Path

import pytest

from tests.real_ros import differences
from tests.real_ros.findings import FINDINGS, MEDIUM, SERIOUS, STATEMENTS
from tests.real_ros.test_outcomes import FILES, frozen_outcomes
from tests.real_ros.test_programs import FROZEN

TESTS = Path(__file__).parents[1]
PAGE = (TESTS.parent / "docs" / "simulated.md").read_text("utf-8")
ROWS = {line.strip("|").split(" | ")[0].strip() for line in PAGE.splitlines() if line.startswith("| ")}
NAMES = {
    name
    for file in TESTS.rglob("test_*.py")
    for name in re.findall(r"^(?:async )?def (test_\w+)", file.read_text("utf-8"), re.MULTILINE)
}


def _exists(kind: str, name_of_evidence: str) -> bool:
    if kind == "probe":
        file, name = name_of_evidence.split(" ")
        return file in FILES and name in frozen_outcomes(file)
    return name_of_evidence in {"program": FROZEN, "test": NAMES, "row": ROWS}[kind]


@pytest.mark.parametrize("subject", FINDINGS)
def test_evidence_of_each_finding_exists(subject: str) -> None:
    assert FINDINGS[subject]
    for shown_by in FINDINGS[subject]:
        assert _exists(*shown_by.split(" ", 1)), shown_by


@pytest.mark.parametrize("subject", FINDINGS)
def test_finding_without_a_row_agrees_with_the_real_rclpy(subject: str) -> None:
    rows = {what for kind, what in (shown.split(" ", 1) for shown in FINDINGS[subject]) if kind == "row"}
    for kind, what in (shown.split(" ", 1) for shown in FINDINGS[subject]):
        if kind == "probe":
            file, name = what.split(" ")
            difference = differences.PROBES.get(file, {}).get(name)
            assert difference is None or difference.row in rows, what


def test_all_findings_are_listed() -> None:
    assert (len(SERIOUS), len(MEDIUM), len(STATEMENTS)) == (6, 18, 11)


@pytest.mark.parametrize("shown_by", ["probe qos plain.nothing", "test test_of_nothing", "row Nothing"])
def test_missing_evidence_is_found(shown_by: str) -> None:
    assert not _exists(*shown_by.split(" ", 1))
