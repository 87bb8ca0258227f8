"""The files of the project that git keeps; a test that needs them is skipped where there is no git."""

import shutil
import subprocess
from pathlib import Path

import pytest

from tests.patience import PATIENCE

ROOT = Path(__file__).parents[1]


def need_git() -> None:
    if shutil.which("git") is None:
        pytest.skip("no git on this machine")


def tracked() -> list[Path]:
    """List the files, relative to ROOT."""
    need_git()
    process = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    if process.returncode != 0:
        pytest.skip("not a git checkout")
    return [path for path in map(Path, process.stdout.splitlines()) if (ROOT / path).is_file()]
