"""`resume()`, which runs the cells up to the one where the student stopped in a new kernel.

Lessons run in a few seconds at full speed, so all cells above are run again, not only those that
define names used below: a view also depends on nodes that no later cell refers to. The outputs of
the cells stay hidden.
"""

import ast
import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError, format_count
from course_lib.ros.graph.graph import current_graph
from course_lib.ros.time.driving import drive_between_cells, live_runs
from course_lib.third_party import read_bytes, read_json

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

# Functions that only ask questions or check answers. No later cell depends on them.
_QUESTION_CALLS = {"ask_identity", "check", "compare", "predict", "quiz", "resume"}
_PACE = "COURSE_PACE"
# Sources that `resume` has run in this kernel, in the order of their runs. IPython's history lacks them.
resumed_sources: list[str] = []
# Whether `resume` is running cells, which may call `resume` themselves.
_is_resuming = False


@dataclass(frozen=True)
class _Cell:
    """A code cell: its id, its number among the code cells (from 1), and its source."""

    id: str
    number: int
    source: str


def resume() -> None:
    """Run the cells above this one that this kernel has not run, at full speed and without their outputs.

    Use it after a restart or on the next day: ``resume()`` in the cell where you want to continue.
    Cells that only ask questions or check answers are skipped. The cells are read from the
    notebook's file, so save your changes first.

    It does nothing in kernels that were not started by a server (nbclient, scripts), which run all
    cells in order, and in a cell that another ``resume()`` runs.

    Raises:
        CourseError: No saved notebook contains this cell.
    """
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    if shell is None or _is_resuming or "JPY_SESSION_NAME" not in os.environ:
        return
    # From the first cell that this kernel has not run, except interactive cells. A cell that was run
    # before another one that was not run is run again, because it may depend on it.
    cells = [c for c in _cells_above(shell) if c.source.strip() and not _is_interactive(shell, c.source)]
    history = getattr(shell.history_manager, "input_hist_raw", [])
    run_sources = {str(source).strip() for source in (*history, *resumed_sources)}
    first = next((i for i, c in enumerate(cells) if c.source.strip() not in run_sources), len(cells))
    waiting = cells[first:]
    if not waiting:
        print("All cells above have been run. Continue below.")  # noqa: T201  the cell's output
        return
    failed = []
    with _resuming():
        for cell in waiting:
            fault = _run(shell, cell.source)
            resumed_sources.append(cell.source)
            if fault:
                failed.append(f"  In [{cell.number}]: {fault}")
    lines = [f"Ran {format_count(len(waiting), 'cell')} above. Continue below."]
    if failed:
        lines += ["Errors, as when you run these cells yourself:", *failed]
    print("\n".join(lines))  # noqa: T201  the cell's output
    graph = current_graph()
    for run in live_runs(graph):
        run.show()
        drive_between_cells(graph)


def line_that_defines(shell: "InteractiveShell", name: str) -> str:
    """Return the line of a cell above the running one that defines a name, as last saved, or ""."""
    if "JPY_SESSION_NAME" not in os.environ:
        return ""
    try:
        cells = _cells_above(shell)
    except CourseError:
        return ""
    names = rf"(?:\w+, *)*{re.escape(name)}(?:, *\w+)*"
    definition = re.compile(
        rf"^(?:(?:class|def) {re.escape(name)}\b|{names} *(?::[^=\n]+)?=(?!=)).*", re.MULTILINE
    )
    found = (definition.search(cell.source) for cell in cells)
    return next((match[0] for match in found if match), "")


def _cells_above(shell: "InteractiveShell") -> list[_Cell]:
    """Return the code cells above the running one, from the notebook's file as last saved."""
    parent: dict[str, Any] = getattr(shell, "get_parent", dict)() or {}
    running_id = parent.get("metadata", {}).get("cellId")
    source = str(parent.get("content", {}).get("code", "")).strip()
    # The notebook of this kernel, then the other notebooks of its folder, newest first.
    name = os.environ.get("JPY_SESSION_NAME", "")
    folder = Path(name).parent if name and Path(name).parent.is_dir() else Path.cwd()
    notebooks = sorted(folder.glob("*.ipynb"), key=lambda path: -path.stat().st_mtime)
    if name.endswith(".ipynb") and Path(name).is_file():
        notebooks.insert(0, Path(name))
    files = [list(_code_cells(path)) for path in notebooks]
    # JupyterLab sends the id of the cell. Other pages use different ids, so the source is compared.
    for cells in files:
        ids = [cell.id for cell in cells]
        if running_id in ids:
            return cells[: ids.index(running_id)]
    for cells in files:
        sources = [cell.source.strip() for cell in cells]
        if source in sources:
            return cells[: sources.index(source)]
    raise CourseError("This cell is not in a saved notebook of its folder. Save (Ctrl+S) and run it again.")


def _code_cells(path: Path) -> Iterator[_Cell]:
    try:
        notebook = read_json(read_bytes(path))
    except (OSError, ValueError):
        return
    cells = notebook.get("cells", []) if isinstance(notebook, dict) else []
    number = 0
    for cell in cells:
        if isinstance(cell, dict) and cell.get("cell_type") == "code":
            number += 1
            source = cell.get("source", "")
            yield _Cell(
                str(cell.get("id", "")), number, "".join(source) if isinstance(source, list) else source
            )


def _is_interactive(shell: "InteractiveShell", source: str) -> bool:
    """Return whether a cell only calls functions that ask or check, or waits for a click."""
    try:
        tree = ast.parse(shell.transform_cell(source))
    except SyntaxError:
        # A cell that does not compile is skipped, because it would not run either.
        return True
    if any(isinstance(node, ast.Await) for statement in tree.body for node in ast.walk(statement)):
        return True
    # An import of `resume` alone may precede its call. It does not need to run.
    body = [statement for statement in tree.body if not ast.unparse(statement).endswith(" import resume")]
    calls = [
        statement.value
        for statement in body
        if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Call)
    ]
    names = [call.func.id for call in calls if isinstance(call.func, ast.Name)]
    return bool(tree.body) and len(names) == len(body) and set(names) <= _QUESTION_CALLS


@contextmanager
def _resuming() -> Iterator[None]:
    """Let robot time pass at full speed, even if a page is open, and nested calls of `resume` do nothing."""
    global _is_resuming
    previous_pace = os.environ.get(_PACE)
    _is_resuming, os.environ[_PACE] = True, "fast"
    try:
        yield
    finally:
        _is_resuming = False
        if previous_pace is None:
            del os.environ[_PACE]
        else:
            os.environ[_PACE] = previous_pace


def _run(shell: "InteractiveShell", source: str) -> str:
    """Run a cell without displaying its output. Return its error on one line, or ""."""
    from unittest.mock import patch

    from IPython.core.displaypub import CapturingDisplayPublisher
    from IPython.utils.capture import capture_output

    # Messages of JupyterLab's widgets arrive in another thread while a cell runs. For each of them
    # the kernel calls `set_parent` of the display publisher, a method that the capturing one lacks.
    receiving = patch.object(
        CapturingDisplayPublisher, "set_parent", lambda publisher, parent: None, create=True
    )
    # A kernel sends the traceback as a separate message, which cannot be captured as output.
    silent = patch.object(shell, "_showtraceback", lambda *_: None)
    with receiving, capture_output(), silent:
        result = shell.run_cell(source, store_history=False, silent=True)
    error = result.error_before_exec or result.error_in_exec
    return "" if error is None else f"{type(error).__name__}: {error}".splitlines()[0]
