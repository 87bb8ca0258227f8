"""Lessons, run once without a page, as pages of a book: their outputs, and their scenes in files."""

import base64
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from subprocess import DEVNULL
from typing import Any

import nbclient
import nbformat
from nbclient.exceptions import CellExecutionError, CellTimeoutError

from course_lib.book.guides import LESSONS
from course_lib.course.exercise import notebook_text, read_notebook, source
from course_lib.course.hand_out import prepare
from course_lib.course.state import write_whole
from course_lib.errors import CourseError

SECONDS = 120  # [s] for a cell
HERE = "…/.venv"  # takes the place of the folder of this Python
START = 180  # [s] for a kernel, on a busy machine
SCENES = "_scenes"  # of the book
KERNEL = "__import__('course_lib.book.kernel', fromlist=['begin'])"
SHOWN_BY_SCRIPTS = "application/vnd.jupyter.widget-view+json"
# What a prediction's answer is stays in the lesson that students run; nobody watches a book being made.
UNSAID = re.compile(
    r"^You predicted: .*?(?=^Measured: |\Z)|^No page is watching: [^\n]*\n", re.MULTILINE | re.DOTALL
)
ATTACHED = re.compile(r"attachment:([^)\s]+)")
NAMED = re.compile(r"(?<!\[)`(\w+\.ipynb)`")
BANNER = """
:::{{note}}
This page is for reading: it shows what the cells of the lesson show. Turn the 3D scenes with the mouse, and
press ▶ below them. To run and change cells, to answer questions and to use the panels,
[install the course](../index.md), type `course lab` and open `{name}`.
:::
"""


def make_page(lesson: Path, book: Path, work: Path) -> None:
    """Run a lesson, and write it with its outputs, pictures and scenes into the sources of a book.

    Args:
        lesson: The notebook.
        book: The folder of the sources.
        work: A folder to run in, which becomes a student's.

    Raises:
        CourseError: A cell fails, or does not end.
    """
    prepare(work)
    notebook = run_lesson(lesson, book / "_extra" / SCENES, work)
    others = {path.name for path in lesson.parent.glob("*.ipynb")} - {lesson.name}
    for cell in notebook["cells"]:
        if cell["cell_type"] == "markdown":
            cell["source"] = _linked(cell["source"], others)
        if cell["cell_type"] == "code":
            cell["outputs"] = [kept for output in cell["outputs"] for kept in _kept(output)]
        for name, data in _attachments(cell):
            write_whole(book / LESSONS / "images" / lesson.stem / name, data)
        if "attachments" in cell:
            cell["source"] = ATTACHED.sub(rf"images/{lesson.stem}/\1", cell["source"])
            del cell["attachments"]
    _introduce(notebook["cells"], BANNER.format(name=lesson.name))
    write_whole(book / LESSONS / lesson.name, notebook_text(notebook).encode())


def _introduce(cells: list[Any], words: str) -> None:
    """Put words below the title of a lesson."""
    for cell in cells:
        if cell["source"].startswith("# "):
            title, _, rest = cell["source"].partition("\n")
            cell["source"] = f"{title}\n{words}{rest}"
            return


def _linked(text: str, others: set[str]) -> str:
    """Return Markdown in which the names of other lessons lead to their pages."""

    def link(named: re.Match[str]) -> str:
        return f"[{named[0]}]({named[1]})" if named[1] in others else named[0]

    return NAMED.sub(link, text)


def run_lesson(lesson: Path, scenes: Path, work: Path) -> Any:
    """Run a lesson's cells without a page; its scenes become files."""
    plain = read_notebook(lesson)
    begin = f"{KERNEL}.begin({lesson.stem!r}, {str(scenes)!r}, '../{SCENES}')"
    plain["cells"] = [_cell("book-begin", begin), *plain["cells"], _cell("book-end", f"{KERNEL}.end()")]
    notebook: Any = nbformat.reads(notebook_text(plain), as_version=4)  # type: ignore[no-untyped-call]  # has no types
    place = ["before its first cell"]

    def note(cell: Any, cell_index: int) -> None:
        is_last = cell_index == len(notebook["cells"]) - 1
        code = source(cell).partition("\n")[0]
        place[0] = "after its last cell" if is_last else f"cell {cell_index}, {code!r}"

    work_dir = {"metadata": {"path": str(work)}}
    client = nbclient.NotebookClient(
        notebook,
        timeout=SECONDS,
        startup_timeout=START,
        store_widget_state=False,
        resources=work_dir,
        on_cell_start=note,
    )
    try:
        client.execute(env=_environment(), stderr=DEVNULL)
    except (CellExecutionError, CellTimeoutError, RuntimeError) as error:  # kernels
        raise CourseError(f"{lesson.name}, {place[0]}: {_reason(error)}.") from error
    except AssertionError as error:  # nbclient's own, where Ctrl+C has ended the kernel
        raise KeyboardInterrupt from error
    notebook["cells"] = notebook["cells"][1:-1]
    return notebook


def _cell(name: str, code: str) -> dict[str, Any]:
    empty: dict[str, Any] = {"execution_count": None, "metadata": {}, "outputs": []}
    return {"cell_type": "code", "id": name, "source": code, **empty}


def _environment() -> dict[str, str]:
    """Return the environment of a kernel whose robot time passes at full speed."""
    return {**os.environ, "COURSE_PACE": "fast"}


def _reason(error: Exception) -> str:
    if isinstance(error, CellExecutionError):
        return f"{error.ename}: {error.evalue}. Correct that, then run course book again"
    if isinstance(error, CellTimeoutError):
        return f"it did not end within {SECONDS} s. Let it end by itself, then run course book again"
    return "its kernel died or did not start. Run the lesson in JupyterLab to see why"


def _kept(output: Any) -> Iterator[Any]:
    """Yield an output without what needs a kernel, and without answers and folders of this machine."""
    if output["output_type"] == "stream":
        output["text"] = UNSAID.sub("", output["text"]).replace(sys.prefix, HERE)
        if output["text"].strip():
            yield output
        return
    output.get("data", {}).pop(SHOWN_BY_SCRIPTS, None)
    yield output


def _attachments(cell: Any) -> Iterator[tuple[str, bytes]]:
    for name, kinds in cell.get("attachments", {}).items():
        yield name, base64.b64decode(next(iter(kinds.values())))
