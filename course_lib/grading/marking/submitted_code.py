"""The code of a submission, with syntax highlighting, for the page on which graders mark."""

import re
from itertools import groupby
from pathlib import Path
from typing import Any

from pygments.lexers.python import PythonLexer
from pygments.token import Token

from course_lib.errors import CourseError
from course_lib.grading.records import Submission
from course_lib.grading.reports.rendering import strip_control_characters
from course_lib.grading.submissions.archives import working_files
from course_lib.grading.submissions.notebook import parse_notebook
from course_lib.grading.submissions.submission import content_hash, graded_file, unpack
from course_lib.grading.task import Task

MAX_SHOWN = 60_000  # characters of a cell or file
MAX_COLOURED = 20_000  # characters of a cell
MAX_CELLS = 300
# Syntax highlighting classes of the page, by pygments' tokens.
KINDS = (
    (Token.Comment, "remark"),
    (Token.Literal.String, "string"),
    (Token.Literal.Number, "number"),
    (Token.Keyword, "keyword"),
    (Token.Operator.Word, "keyword"),
    (Token.Name.Function, "name"),
    (Token.Name.Class, "name"),
)
Pieces = list[tuple[str, str]]  # kind and text


def submitted_code(submission: Submission, out: Path, task: Task | None) -> dict[str, Any]:
    """Return the code cells and files of a submission as plain data, or an error message.

    Args:
        submission: As its result has it.
        out: The folder of records.
        task: The task whose cells are marked.
    """
    path = graded_file(submission, out)
    try:
        data, _ = unpack(path)
        notebook = parse_notebook(data, path.name)
        files = working_files(path, notebook.cells)
    except CourseError as error:
        return {
            "cells": [],
            "problem": f"The code can't be shown: {error} Has the folder of submissions been moved? "
            "`course grade` with --resume finds it again.",
        }
    is_unchanged = submission.sha256 in (content_hash(data, files), content_hash(data, {}))
    own_pattern = _own_line_pattern(task) if task else None
    cells = [
        {
            "title": f"Cell {number}",
            "own": bool(own_pattern and own_pattern.search(code)),
            "pieces": _highlight(code) if len(code) <= MAX_COLOURED else _plain(code),
        }
        for number, code in enumerate(notebook.cells[:MAX_CELLS], 1)
    ]
    more = [
        {"title": strip_control_characters(name), "own": False, "pieces": _plain(text)}
        for name, text in files.items()
    ]
    return {
        "cells": [*cells, *more],
        "problem": "" if is_unchanged else "This file has changed since it was graded.",
    }


def _own_line_pattern(task: Task) -> re.Pattern[str]:
    """Return a pattern for lines that define a task's object or check it.

    The code need not be valid.
    """
    name = re.escape(task.name)
    binds = rf"^(?:class|def|async def)\s+{name}\b|^{name}\s*[:=]"
    return re.compile(rf"{binds}|[\"']{re.escape(task.id)}[\"']", re.MULTILINE)


def _plain(text: str) -> Pieces:
    hidden_length = len(text) - MAX_SHOWN
    note = [("remark", f"\n… {hidden_length} more characters")] if hidden_length > 0 else []
    return [("", strip_control_characters(text[:MAX_SHOWN])), *note]


def _highlight(code: str) -> Pieces:
    """Split a cell into pieces with one highlighting class each."""
    tokens = PythonLexer(ensurenl=False, stripnl=False).get_tokens(strip_control_characters(code))
    kinds = (
        (next((kind for token_group, kind in KINDS if token in token_group), ""), text)
        for token, text in tokens
        if text
    )
    return [
        (kind, "".join(text for _, text in group)) for kind, group in groupby(kinds, key=lambda pair: pair[0])
    ]
