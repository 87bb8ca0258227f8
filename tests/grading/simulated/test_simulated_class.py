"""A small class, handed in, collected, graded, marked and returned by the commands."""

from pathlib import Path

import pytest

from tests.benchmarks import bench_weeks
from tests.grading.simulated import hand_ins
from tests.grading.simulated.simulated_class import SimulatedClass


@pytest.mark.slow
def test_weeks_graded_by_the_commands_get_the_declared_marks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hand_ins, "KINDS", ("right", "miss", "broken"))
    simulated = SimulatedClass(tmp_path, ("s0", "s1", "s2", "s3"), ("week01", "week03"))
    assert bench_weeks.graded_weeks(simulated, jobs=1) == []
    assert (tmp_path / "filled.csv").is_file()
