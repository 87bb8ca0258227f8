"""The source of a student's object, as `check` finds it in a notebook."""

import functools
import linecache
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from course_lib.grading.own_source import source_in_cells, source_of

CELL = "class Square:\n\n    def area(self, side):\n        return side ** 2"


@pytest.fixture
def run_cells(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """Return a function that runs cells as a kernel does, in a module without a file."""
    module = ModuleType("__main__")
    monkeypatch.setitem(sys.modules, "__main__", module)
    files = []

    def run(*cells: str) -> dict[str, Any]:
        for number, cell in enumerate(cells):
            name = f"<own source {number}>"
            files.append(name)
            linecache.cache[name] = (len(cell), None, cell.splitlines(keepends=True), name)
            exec(compile(cell, name, "exec"), vars(module))
        return vars(module)

    yield run
    for name in files:
        linecache.cache.pop(name, None)


def both(run_cells: Any, name: str, cells: Sequence[str], week: str = "week02") -> str:
    """Return the source, which a run notebook and its file must have in common."""
    source = source_of(run_cells(*cells)[name], week)
    assert source_in_cells(name, cells, week) == source
    return source


def test_class_of_a_cell_has_a_source(run_cells: Any) -> None:
    assert both(run_cells, "Square", [CELL]) == CELL


def test_helper_of_another_cell_belongs_to_the_source(run_cells: Any) -> None:
    cells = ["def half(x):\n    return x // 2", "def unused():\n    pass", "def side(x):\n    return half(x)"]
    assert (
        both(run_cells, "side", cells)
        == "def side(x):\n    return half(x)\n\ndef half(x):\n    return x // 2"
    )


def test_lambda_is_a_function(run_cells: Any) -> None:
    assert both(run_cells, "half", ["half = lambda x: x / 2"]) == "def half(x):\n    return x / 2"


def test_function_behind_decorators_is_found(run_cells: Any) -> None:
    names = run_cells("import functools\n@functools.cache\ndef half(x):\n    return x / 2")
    expected = "@functools.cache\ndef half(x):\n    return x / 2"
    assert source_of(names["half"], "week02") == expected
    assert source_of(functools.partial(names["half"], 1), "week02") == expected


def test_helper_of_an_enclosing_function_is_found(run_cells: Any) -> None:
    cell = "def make():\n    def half(x):\n        return x / 2\n    return lambda x: half(x)\nside = make()"
    names = run_cells(cell, "def area(x):\n    return side(x)")
    assert "def half(x)" in source_of(names["make"], "week02")


def test_helper_of_an_imported_file_belongs_to_the_source(
    run_cells: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "my_helpers.py").write_text("def half(x):\n    return x // 2\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "my_helpers", raising=False)
    names = run_cells("import my_helpers\ndef side(x):\n    return my_helpers.half(x)")
    assert "return x // 2" in source_of(names["side"], "week02")


def test_handed_out_helper_is_left_out_unless_it_was_changed(run_cells: Any) -> None:
    handed_out = 'def shifted(shift):\n    """A transform child to parent, shape (4, 4): shifted, [m]."""\n'
    handed_out += "    matrix = np.eye(4)\n    matrix[:3, 3] = shift\n    return matrix"
    use = "def place(shift):\n    return shifted(shift)"
    assert both(run_cells, "place", [handed_out, use]) == use
    changed = handed_out.replace("[:3, 3]", "[3, :3]")
    assert "matrix[3, :3] = shift" in both(run_cells, "place", [changed, use])


@pytest.mark.parametrize("subject", [None, 3, "side", len, int, object(), functools.partial(len)])
def test_other_objects_have_no_source(subject: object) -> None:
    assert source_of(subject, "week02") == ""
