import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
GATES = {
    "ruff check": ["ruff", "check", "--no-cache"],
    "ruff format": ["ruff", "format", "--check", "--no-cache"],
    "mypy": ["mypy"],
}


@pytest.mark.slow
@pytest.mark.parametrize("gate", GATES)
def test_the_whole_tree_passes(gate: str) -> None:
    command = [sys.executable, "-m", *GATES[gate], "course_lib", "exercises", "solutions", "tests"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
