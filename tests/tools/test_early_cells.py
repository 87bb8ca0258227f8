"""The hint for a name that a cell above defines, where that cell has not run."""

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from course_lib.tools.resume import line_that_defines

CELLS = {
    "drawer": "# export\nclass DetectionDrawer(DashboardNode):\n    pass",
    "view": "viewer = Viewer()\nfocal, middle = 200.0, 120.0  # [px]\nlimit: int = 3",
    "here": "class PerceptionNode(DetectionDrawer):\n    pass",
    "below": "live = run_live(PerceptionNode())",
}


@pytest.fixture
def shell(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """A shell that runs the cell `here` of a saved notebook."""
    cells = [{"cell_type": "code", "id": key, "source": text} for key, text in CELLS.items()]
    path = tmp_path / "lesson.ipynb"
    path.write_text(json.dumps({"cells": cells}), encoding="utf-8")
    monkeypatch.setenv("JPY_SESSION_NAME", str(path))
    return SimpleNamespace(get_parent=lambda: {"metadata": {"cellId": "here"}})


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("DetectionDrawer", "class DetectionDrawer(DashboardNode):"),
        ("viewer", "viewer = Viewer()"),
        ("middle", "focal, middle = 200.0, 120.0  # [px]"),
        ("limit", "limit: int = 3"),
        ("live", ""),
        ("view", ""),
    ],
)
def test_line_of_a_cell_above_that_defines_a_name_is_found(shell: Any, name: str, line: str) -> None:
    assert line_that_defines(shell, name) == line


def test_kernel_without_a_notebook_has_no_cells_above(shell: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("JPY_SESSION_NAME")
    assert line_that_defines(shell, "viewer") == ""


def test_cell_of_an_unsaved_notebook_has_no_cells_above(shell: Any) -> None:
    shell.get_parent = lambda: {"metadata": {"cellId": "new"}, "content": {"code": "a = 1"}}
    assert line_that_defines(shell, "viewer") == ""
