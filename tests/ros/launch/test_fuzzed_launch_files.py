"""A sample of the mutations of which tests/benchmarks/bench_malformed.py runs thousands."""

from pathlib import Path

import pytest

from tests.ros.launch.fuzzing import run_mutations


@pytest.mark.slow
def test_mutated_launch_file_raises_no_exception_and_shows_no_kit_lines(tmp_path: Path) -> None:
    assert list(run_mutations(seed=0, count=60, folder=tmp_path)) == []
