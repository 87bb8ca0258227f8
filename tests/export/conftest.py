import json
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from course_lib.export.export import export

PROGRAMS = Path(__file__).parents[1] / "programs"
CELLS = (PROGRAMS / "dashboard.py").read_text().split("# %%\n")[1:]


def write_notebook(path: Path, cells: Sequence[str]) -> Path:
    """Write code cells as a notebook."""
    code: list[dict[str, object]] = [
        {"cell_type": "code", "metadata": {}, "outputs": [], "execution_count": None, "source": cell}
        for cell in cells
    ]
    path.write_text(json.dumps({"nbformat": 4, "nbformat_minor": 5, "metadata": {}, "cells": code}))
    return path


@pytest.fixture(scope="session")
def notebook(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The dashboard of three nodes as a notebook, as students have it."""
    cells = ["%load_ext course_lib\n", *CELLS]
    return write_notebook(tmp_path_factory.mktemp("work") / "dashboard.ipynb", cells)


@pytest.fixture(scope="session")
def package(notebook: Path) -> Path:
    """The package that export makes of it."""
    export(notebook, "perception_dashboard", notebook.parent / "src")
    return notebook.parent / "src" / "perception_dashboard"


@pytest.fixture
def exported(tmp_path: Path) -> Callable[..., str]:
    """Export cells with one node, Talker. Return its module."""

    def make(*cells: str) -> str:
        file = write_notebook(tmp_path / "cells.ipynb", cells)
        export(file, "my_package", tmp_path, force=True)
        return (tmp_path / "my_package" / "my_package" / "talker.py").read_text()

    return make
