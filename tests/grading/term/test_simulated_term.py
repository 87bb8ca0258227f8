"""A small term, really handed in, collected, graded and added up by the commands, and computed again."""

from pathlib import Path

import pytest

from tests.benchmarks import bench_term
from tests.grading.term import handed_in
from tests.grading.term.simulated_term import SimulatedTerm


@pytest.mark.slow
def test_a_term_through_the_commands_gets_the_declared_marks_and_recomputed_totals(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bench_term, "REQUESTS", 1)
    monkeypatch.setattr(handed_in, "KINDS", ("right", "miss", "broken"))
    term = SimulatedTerm(tmp_path, ("s0", "s1", "s2", "s3"), ("week01", "week03"))
    assert bench_term.graded_term(term, jobs=1) == []
    assert (tmp_path / "graded/term.csv").read_text().count("\n") == 1 + len(term.students)
    assert (tmp_path / "totals.csv").is_file()
