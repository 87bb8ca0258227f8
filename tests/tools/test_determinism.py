"""The same program gives the same recording, byte for byte."""

import hashlib
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from course_lib.recording import read_bag
from tests.patience import PATIENCE

PROGRAMS = Path(__file__).parents[1] / "programs"
SCRIPT = """
import sys
from pathlib import Path
from course_lib.tools.run import run
folder, runs, *programs = sys.argv[1:]
for number in range(int(runs)):
    for program in map(Path, programs):
        bag = Path(folder) / str(number) / program.stem
        run([program], seconds=3.0, seed=1, bag=bag, args=(), real_time=False)
"""


@pytest.mark.parametrize(
    ("processes", "runs"),
    [(3, 1), pytest.param(4, 5, marks=pytest.mark.slow)],
    ids=["3", "20"],
)
def test_repeated_runs_of_each_program_give_one_digest_and_equal_bytes(
    tmp_path: Path, processes: int, runs: int
) -> None:
    programs = sorted(PROGRAMS.glob("*.py"))

    def run(number: int) -> list[dict[str, tuple[str, str]]]:
        folder = tmp_path / str(number)
        command = [sys.executable, "-c", SCRIPT, str(folder), str(runs), *map(str, programs)]
        subprocess.run(
            command,
            env=os.environ | {"PYTHONHASHSEED": "0"},
            check=True,
            capture_output=True,
            timeout=PATIENCE,
        )
        return [{p.stem: _facts(folder / str(n) / p.stem) for p in programs} for n in range(runs)]

    with ThreadPoolExecutor(2) as pool:
        first, *others = (facts for run_facts in pool.map(run, range(processes)) for facts in run_facts)
    assert len(first) == len(programs) > 6
    assert len(others) == processes * runs - 1
    for program, facts in first.items():
        assert {other[program] for other in others} == {facts}, program


def _facts(bag: Path) -> tuple[str, str]:
    recording = read_bag(bag)
    assert len(recording.samples) > 10
    return recording.digest(), hashlib.sha256((bag / "recording.mcap").read_bytes()).hexdigest()
