"""The code of a submission, as the page for marking shows it."""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pygments.lexers.python import PythonLexer
from pygments.token import Token

from course_lib.errors import CourseError
from course_lib.grading.handin.archives import working_files
from course_lib.grading.handin.notebook import parse_notebook
from course_lib.grading.handin.submission import content_hash, unpack
from course_lib.grading.reports.table import tame
from course_lib.grading.task import Task

MAX_SHOWN = 60_000  # characters of a cell or a file
MAX_COLOURED = 20_000  # characters of a cell
MAX_CELLS = 300
KINDS = (  # of code, by pygments' tokens
    (Token.Comment, "remark"),
    (Token.Literal.String, "string"),
    (Token.Literal.Number, "number"),
    (Token.Keyword, "keyword"),
    (Token.Operator.Word, "keyword"),
    (Token.Name.Function, "name"),
    (Token.Name.Class, "name"),
)
Pieces = list[tuple[str, str]]  # kind and text


def handed_in(result: Mapping[str, Any], task: Task | None) -> dict[str, Any]:
    """Return the code cells and files of a submission as plain data, or why they can't be shown.

    Args:
        result: The content of a result's file.
        task: Whose cells are marked.
    """
    path = Path(result["file"])
    try:
        data, _ = unpack(path)
        notebook = parse_notebook(data, path.name)
        files = working_files(path, notebook.cells)
    except CourseError as error:
        return {"cells": [], "problem": _lost(f"The code can't be shown: {error}")}
    known = result["sha256"] in (content_hash(data, files), content_hash(data, {}))
    own = _own_lines(task) if task else None
    cells = [
        {"title": f"Cell {number}", "own": bool(own and own.search(code)), "pieces": _pieces(code)}
        for number, code in enumerate(notebook.cells[:MAX_CELLS], 1)
    ]
    more = [{"title": tame(name), "own": False, "pieces": _plain(text)} for name, text in files.items()]
    return {
        "cells": [*cells, *more],
        "problem": "" if known else "This file has changed since it was graded.",
    }


def _lost(said: str) -> str:
    return f"{said} Paths count from the folder in which `course grade` was started: start this page there."


def _own_lines(task: Task) -> re.Pattern[str]:
    """Return a pattern of lines that bind a task's object or check it; the code is not parsed."""
    name = re.escape(task.name)
    binds = rf"^(?:class|def|async def)\s+{name}\b|^{name}\s*[:=]"
    return re.compile(rf"{binds}|[\"']{re.escape(task.id)}[\"']", re.MULTILINE)


def _pieces(code: str) -> Pieces:
    """Return a cell in pieces of one kind each."""
    return list(_coloured(tame(code))) if len(code) <= MAX_COLOURED else _plain(code)


def _plain(text: str) -> Pieces:
    left = len(text) - MAX_SHOWN
    note = [("remark", f"\n… {left} more characters")] if left > 0 else []
    return [("", tame(text[:MAX_SHOWN])), *note]


def _coloured(code: str) -> Iterator[tuple[str, str]]:
    last, text = "", ""
    for token, piece in PythonLexer(ensurenl=False, stripnl=False).get_tokens(code):
        kind = next((kind for known, kind in KINDS if token in known), "")
        if kind != last and text:
            yield last, text
            text = ""
        last, text = kind, text + piece
    if text:
        yield last, text
