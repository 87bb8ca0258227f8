"""A submitted notebook and its code cells, read as untrusted data."""

import ast
import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from course_lib.course.exercise import normalise, source
from course_lib.course.state import cell_digest
from course_lib.errors import CourseError
from course_lib.export.module import bound_names, imported_modules, mutated_names, without_magics
from course_lib.third_party import compile_python, parse_python, read_json

MAX_BYTES = 20_000_000  # [B] limit for a notebook without its outputs, and for any other file
MAX_WITH_OUTPUTS = 100_000_000  # [B] limit for a notebook as submitted
MAX_TOKENS = 4_000_000  # limit on the JSON tokens that are scanned for outputs
MAX_BRACKETS = 1_000_000  # limit on objects and lists, which take up to 250 B of memory each
# file names into which some systems turn .ipynb
NOTEBOOK_NAME = re.compile(r"\.ipynb(\.txt|\.json)?$|\.json$", re.IGNORECASE)
# Possessive, because an escape to return to would take 80 bytes of memory. A string without an end
# is one token, because another search would begin at each of its escaped quotes.
TOKEN = re.compile(rb'"(?:[^"\\]++|\\.)*+(?:"|\\?\Z)|[\[\]{}]', re.DOTALL)
OUTPUTS = re.compile(rb'"(?:outputs|attachments|widgets)"')
OPENS = re.compile(rb"\s*:\s*([\[{])")
LOOKS_LIKE = {
    b"<": "it looks like a web page",
    b"%pdf": "it is a PDF",
    b"pk": "it is a zip archive",
    b"rar!": "it is a RAR archive",
    b"7z\xbc\xaf": "it is a 7z archive",
    b"vers": "it is a pointer of Git LFS to a file that is missing here",
}
SAVE_AGAIN = "Save it again in JupyterLab"
CONFLICT = re.compile(rb"^(<{7} |>{7} )", re.MULTILINE)  # conflict markers of git
_RUN = re.compile(r"^%run\s+([\w./-]+\.py)\b", re.MULTILINE)
# The text about a file of `own_modules`.
NOT_SUBMITTED = (
    "{0} is not part of your submission, and your code will not find it at grading: copy what you "
    "need from {0} into a cell of the notebook."
)
MAX_HEAD = 40  # limit on the characters of a cell's first line


@dataclass(frozen=True)
class Notebook:
    """A submitted notebook: its code cells, its exercise, and the ID in it.

    `was_run` is True for each code cell that was run, as recorded in the file. `is_lesson` is True if
    the metadata are from a lesson. `digest` is the digest of all cells without outputs.
    """

    cells: tuple[str, ...]
    exercise: str | None = None
    student: str | None = None
    was_run: tuple[bool, ...] = ()
    is_lesson: bool = False
    digest: str = ""


def format_of(data: bytes) -> str:
    """Return the detected format of a file that is not a notebook, as "it is a PDF", or ""."""
    start = data.lstrip()[:4].lower()
    kinds = (text for first, text in LOOKS_LIKE.items() if start.startswith(first))
    return next(kinds, "" if start else "it is empty")


def parse_notebook(data: bytes, name: str) -> Notebook:
    """Parse a notebook's bytes, which may be invalid in any way; `name` is the file's name.

    Raises:
        CourseError: It is too large, not JSON, or not a notebook of format 3 or 4.
    """
    if MAX_BYTES < len(data) <= MAX_WITH_OUTPUTS or _count_brackets(data) > MAX_BRACKETS:
        data = without_outputs(data)
    if len(data) > MAX_BYTES:
        raise CourseError(f"{name} has more than {MAX_BYTES:,} bytes. Clear its outputs and save it.")
    if (count := _count_brackets(data)) > MAX_BRACKETS:
        raise CourseError(
            f"{name} has {count:,} opening brackets, expected at most {MAX_BRACKETS:,}. Clear its outputs "
            "and save it."
        )
    try:
        content = read_json(data)  # in UTF-8, 16 or 32
    except ValueError as error:
        problem, advice = format_of(data) or "it is not JSON", SAVE_AGAIN
        # A conflict marker in the first line begins with "<", like a web page. JupyterLab cannot
        # open a file with conflict markers.
        if CONFLICT.search(data):
            problem = "git's markers of a merge conflict are in it"
            advice = f"Choose one version: git checkout --ours {name}"
        raise CourseError(f"{name} is not a notebook: {problem}. {advice}.") from error
    content = _dict(content)
    # Format 3 stores the cells in worksheets.
    sheets = content.get("worksheets")
    sheet = _dict(sheets[0]) if isinstance(sheets, list) and sheets else {}
    cells = content.get("cells", sheet.get("cells"))
    if not isinstance(cells, list) or not all(isinstance(cell, dict) for cell in cells):
        raise CourseError(
            f"{name} is not a notebook of format 3 or 4: it has no list of cells. Save it again."
        )
    code_cells = [cell for cell in cells if cell.get("cell_type") == "code"]
    code = tuple(source({"source": cell.get("source", cell.get("input", ""))}) for cell in code_cells)
    was_run = tuple(bool(cell.get("execution_count", cell.get("prompt_number"))) for cell in code_cells)
    claims = _dict(_dict(content.get("metadata")).get("course"))
    exercise = find_exercise_name(claims.get("exercise")) or find_exercise_name(name)
    exercise = exercise or _exercise_without_metadata(name, code)
    texts = [
        (cell.get("cell_type") == "code", source({"source": cell.get("source", cell.get("input", ""))}))
        for cell in cells
    ]
    digest = hashlib.sha256(json.dumps(texts).encode()).hexdigest()
    # Exercises have the metadata "exercise" and "minutes", lessons only "minutes".
    is_lesson = "minutes" in claims and "exercise" not in claims
    return Notebook(code, exercise, claimed_id(claims), was_run, is_lesson, digest)


def _count_brackets(data: bytes) -> int:
    return data.count(b"{") + data.count(b"[")


def is_notebook_name(name: str) -> bool:
    """Return whether a file may be a notebook, judging by its name."""
    return NOTEBOOK_NAME.search(name) is not None


def without_outputs(data: bytes) -> bytes:
    """Return a notebook's bytes without outputs, attachments and widget state.

    The text is scanned without building objects, because a notebook of the maximum size would need
    gigabytes. If it is not valid JSON, or has too many tokens, it is returned unchanged.
    """
    chunks, position, depth, is_removing = list[bytes](), 0, 0, False
    for count, token in enumerate(TOKEN.finditer(data)):
        if count > MAX_TOKENS:
            return data
        if is_removing:
            depth += (token[0] in b"[{") - (token[0] in b"]}")
            if depth == 0:
                position, is_removing = token.end() - 1, False
        elif OUTPUTS.fullmatch(token[0]) and (opens := OPENS.match(data, token.end())):
            chunks.append(data[position : opens.end()])
            is_removing = True
    return data if is_removing else b"".join((*chunks, data[position:]))


def find_exercise_name(text: Any) -> str | None:
    """Return the exercise at the beginning of a name, "week01_exercise", or None."""
    match = re.match(r"week\d\d_exercise", text) if isinstance(text, str) else None
    return match and match[0]


def _exercise_without_metadata(name: str, code: Sequence[str]) -> str | None:
    """Return the exercise in a name like "Copy of week01_exercise.ipynb", or None.

    Some editors drop the metadata of a course. The file must call the checks of that week: a
    student's notes may have such a name, too.
    """
    match = re.search(r"(?<![^\W_])(week\d\d)_exercise", name, re.IGNORECASE)
    week = match[1].lower() if match else ""
    is_checked = week and any(re.search(rf"""\bcheck\(\s*["']{week}\.""", cell) for cell in code)
    return f"{week}_exercise" if is_checked else None


def full_exercise_name(text: str) -> str:
    """Return the full name of an exercise, "week01_exercise", given "week01" or a file's name."""
    name = text.strip().removesuffix(".ipynb")
    return f"{name}_exercise" if re.fullmatch(r"week\d\d", name) else name


def claimed_id(claims: Any) -> str | None:
    """Return the normalized ID in a file's metadata, or None. It is valid as a folder name."""
    try:
        claim = _dict(claims).get("student")
        return normalise(claim) if isinstance(claim, str) else None
    except CourseError:
        return None


def _dict(value: Any) -> dict[str, Any]:
    return value if isinstance(value, dict) else {}


@dataclass(frozen=True)
class CodeCell:
    """A code cell: its number among the code cells, its source, and whether it was run."""

    number: int
    source: str
    was_run: bool

    @property
    def name(self) -> str:
        """The cell's name in messages."""
        head = next((line.strip() for line in self.source.splitlines() if line.strip()), "")
        return f"code cell {self.number} ({head[:MAX_HEAD]}{'…' * (len(head) > MAX_HEAD)})"

    @property
    def digest(self) -> str:
        """The digest of the source."""
        return cell_digest(self.source)

    @cached_property
    def tree(self) -> ast.Module:
        """The syntax tree of the cell; empty if the cell cannot be parsed."""
        try:
            return parse_python(without_magics(self.source))
        except (SyntaxError, ValueError):
            return ast.Module([], [])

    @cached_property
    def syntax_error(self) -> str:
        """The syntax error of the cell, or ""."""
        try:
            compile_python(without_magics(self.source), "cell", ast.PyCF_ALLOW_TOP_LEVEL_AWAIT)
        except (SyntaxError, ValueError) as error:
            line = f", line {error.lineno}" if isinstance(error, SyntaxError) and error.lineno else ""
            return f"{self.name}{line}: {getattr(error, 'msg', error)}"
        return ""

    @cached_property
    def bindings(self) -> frozenset[str]:
        """The names that the cell binds, except inside functions and classes."""
        return frozenset(bound_names(self.tree))

    @cached_property
    def changed_names(self) -> frozenset[str]:
        """The names that the cell binds, or whose objects it mutates."""
        mutated = frozenset(name for statement in self.tree.body for name in mutated_names(statement))
        return self.bindings | mutated

    @cached_property
    def used_names(self) -> frozenset[str]:
        """The names that the cell reads, even inside functions and classes."""
        names = (node for node in ast.walk(self.tree) if isinstance(node, ast.Name))
        return frozenset(name.id for name in names if isinstance(name.ctx, ast.Load))

    @cached_property
    def checks(self) -> Mapping[str, ast.expr]:
        """The second argument of each call of `check`, by task."""
        calls = (node for node in ast.walk(self.tree) if isinstance(node, ast.Call) and len(node.args) > 1)
        return {
            str(call.args[0].value): call.args[1]
            for call in calls
            if getattr(call.func, "id", "") == "check" and isinstance(call.args[0], ast.Constant)
        }

    @cached_property
    def is_stub(self) -> bool:
        """True if the cell contains a `raise NotImplementedError`."""
        raised = (node.exc for node in ast.walk(self.tree) if isinstance(node, ast.Raise) and node.exc)
        return any(ast.unparse(exception).startswith("NotImplementedError") for exception in raised)


def own_modules(path: Path, cells: Sequence[str]) -> list[str]:
    """Return the Python files next to a notebook that its cells import or run, which are not submitted."""
    files = dict[str, None]()
    for number, text in enumerate(cells, 1):
        names = [f"{name}.py" for name in sorted(imported_modules(CodeCell(number, text, True).tree))]
        files |= dict.fromkeys([*names, *_RUN.findall(text)])
    return [name for name in files if (path.parent / name).is_file()]
