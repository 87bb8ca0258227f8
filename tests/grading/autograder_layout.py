"""Gradescope's layout: an autograder.zip is set up in a folder like /autograder, and grades one file."""

import json
import os
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from tests.patience import PATIENCE


def graded_upload(archive: Path, handed_in: Path, root: Path) -> dict[str, Any]:
    """Set up an autograder and return its results of a file, which gets the name of an exercise of week 1."""
    tools = root.parent / "bin"
    for folder in (root / "submission", root / "results", tools):
        folder.mkdir(parents=True)
    (tools / "apt-get").write_text('#!/bin/sh\n[ "$1" = update ]\n')  # the image's packages are there
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    # pip comes from this environment, too: its installation would take 4 s of processor time.
    without_pip = f'[ "$2" != venv ] || set -- "$@" --without-pip\nexec {sys.executable} "$@"\n'
    (tools / version).write_text(f"#!/bin/sh\n{without_pip}")
    for program in ("apt-get", version):
        (tools / program).chmod(0o755)
    subprocess.run(
        [sys.executable, "-m", "zipfile", "-e", archive, root / "source"], check=True, timeout=5 * PATIENCE
    )
    (root / "run_autograder").write_bytes((root / "source/run_autograder").read_bytes())
    here = sysconfig.get_path("purelib")  # its dependencies and build requirements are not downloaded again
    settings = {"PYTHONPATH": here, "PIP_NO_BUILD_ISOLATION": "0"}  # 0 is pip's word for "no isolation"
    # Most of the kit's modules are never imported here.
    settings |= {"PIP_NO_COMPILE": "0", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
    _run(root / "source/setup.sh", root, PATH=f"{tools}:{os.environ['PATH']}", **settings)
    packages = next((root / "venv/lib").glob("python*/site-packages"))
    (packages / "dependencies.pth").write_text(f"{here}\n")
    (root / "submission/week01_exercise.ipynb").write_bytes(handed_in.read_bytes())
    _run(root / "run_autograder", root)
    results: dict[str, Any] = json.loads((root / "results/results.json").read_text())
    return results


def _run(script: Path, root: Path, **changed: str) -> None:
    environment = {**os.environ, **changed}
    process = subprocess.run(
        ["bash", script],
        cwd=root,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=5 * PATIENCE,
    )
    assert process.returncode == 0, process.stdout + process.stderr
