"""The code to export: cells of a notebook or a Python file, as module-level statements."""

import ast
import re
import symtable
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from course_lib.course.exercise import code_cells, read_notebook, source
from course_lib.errors import CourseError

_MARK = re.compile(r"\s*#\s*\|?\s*export\s*$", re.MULTILINE)
_AT_ONCE = ("listcomp", "genexpr", "dictcomp", "setcomp")  # scopes that run where they stand


@dataclass(frozen=True)
class Cell:
    """A cell's Python: its number, as it is counted in JupyterLab, and whether it is marked for export."""

    number: int
    source: str
    marked: bool


def read_cells(file: Path) -> list[Cell]:
    """Read a .py file, as one cell, or a notebook's code cells and the modules beside it; no magics.

    Raises:
        CourseError: The file cannot be read, or is not a notebook.
    """
    if file.suffix == ".ipynb":
        cells = (_cell(number, cell) for number, cell in code_cells(read_notebook(file)))
        return [part for cell in cells for part in _with_modules(cell, file.parent)]
    return [Cell(1, _text(file), marked=True)]


def _text(file: Path) -> str:
    try:
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise CourseError(f"{file} cannot be read: {reason}. Name a notebook or a Python file.") from error


def _with_modules(cell: Cell, folder: Path) -> Iterator[Cell]:
    """Yield the code of each module in the folder that a cell imports from, then the cell without that."""
    lines = cell.source.splitlines()
    beside = {name: folder / f"{name}.py" for name in re.findall(r"^from (\w+) import", cell.source, re.M)}
    for name, module in beside.items():
        if module.is_file():
            yield Cell(cell.number, _text(module), cell.marked)
            for node in ast.parse(cell.source).body:
                if isinstance(node, ast.ImportFrom) and node.module == name:
                    first, last = node.lineno - 1, node.end_lineno or node.lineno
                    lines[first:last] = [""] * (last - first)
    yield Cell(cell.number, "\n".join(lines), cell.marked)


def _cell(number: int, cell: dict[str, Any]) -> Cell:
    code, tags = source(cell), cell.get("metadata", {}).get("tags", ())
    return Cell(number, without_magics(code), bool(_MARK.match(code)) or "export" in tags)


def without_magics(source: str) -> str:
    """Return a cell as Python, its magics as calls and without its mark for export."""
    from IPython.core.inputtransformer2 import TransformerManager

    manager = TransformerManager()  # type: ignore[no-untyped-call]  # IPython annotates little
    return _MARK.sub("", manager.transform_cell(source), count=1)


@dataclass(frozen=True)
class Statement:
    """A statement of a cell.

    Attributes:
        order: Its place among all statements.
        text: Its source, with the comments above it; of an import with one name.
        gives: The names that it binds.
        changes: The names of things that it changes in place, like `COLORS["car"] = RED`.
        now: The names that it needs when it runs.
        later: The names that its functions need when they are called.
    """

    order: int
    cell: Cell
    node: ast.stmt = field(repr=False)
    text: str
    gives: frozenset[str]
    changes: frozenset[str]
    now: frozenset[str]
    later: frozenset[str]

    @property
    def is_import(self) -> bool:
        """True for an import."""
        return isinstance(self.node, ast.Import | ast.ImportFrom)


def statements(cells: Sequence[Cell]) -> list[Statement]:
    """Split cells into statements; raise CourseError where one is not valid Python."""
    found: list[Statement] = []
    for cell in cells:
        try:
            nodes = ast.parse(cell.source).body
        except SyntaxError as error:
            raise CourseError(
                f"Cell {cell.number}, line {error.lineno}: {error.msg}. Correct it first."
            ) from error
        for node, text in _parts(cell.source, nodes):
            now, later = _needs(text)
            gives, changes = frozenset(bound_names(node)), frozenset(_changed(node))
            if isinstance(node, ast.AugAssign):
                now |= gives
            elif not isinstance(node, ast.Assign):  # X = X + 1 needs the X before it
                now -= gives
            found.append(Statement(len(found), cell, node, text, gives, changes, now, later))
    return found


def _parts(source: str, nodes: Sequence[ast.stmt]) -> Iterator[tuple[ast.stmt, str]]:
    """Yield each statement with its text; an import of several names as several."""
    lines, end = source.splitlines(), 0
    for node in nodes:
        first = min([node.lineno, *(d.lineno for d in getattr(node, "decorator_list", ()))]) - 1
        begin, end_before = first, end
        while begin > end_before and lines[begin - 1].startswith("#"):
            begin -= 1
        end = node.end_lineno or node.lineno
        if isinstance(node, ast.Import):
            for name in node.names:
                yield (one := ast.Import([name])), ast.unparse(one)
        elif isinstance(node, ast.ImportFrom):
            for name in node.names:
                yield (part := ast.ImportFrom(node.module, [name], node.level)), ast.unparse(part)
        elif first < end_before:  # behind a semicolon
            yield node, ast.unparse(node)
        else:
            yield node, "\n".join(line.rstrip() for line in lines[begin:end])


def bound_names(node: ast.AST) -> Iterator[str]:
    """Yield the names that a statement binds in its module."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        yield node.name
        return
    if isinstance(node, ast.alias):
        yield (node.asname or node.name).partition(".")[0]
    elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
        yield node.id
    if not isinstance(node, ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp | ast.Lambda):
        for child in ast.iter_child_nodes(node):
            yield from bound_names(child)


def _changed(node: ast.stmt) -> Iterator[str]:
    """Yield what a statement changes in place: by a subscript, an attribute, or a call of its method."""
    targets: list[ast.expr] = []
    if isinstance(node, ast.Assign | ast.Delete):
        targets = node.targets
    elif isinstance(node, ast.AugAssign):
        targets = [node.target]
    elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        targets = [node.value.func]
    for target in targets:
        inner: ast.expr = target
        while isinstance(inner, ast.Subscript | ast.Attribute):
            inner = inner.value
        if isinstance(inner, ast.Name) and inner is not target:
            yield inner.id


def _needs(text: str) -> tuple[frozenset[str], frozenset[str]]:
    """Return the names that a text needs when it runs, and when its functions are called."""
    now, later = set[str](), set[str]()

    def look(table: symtable.SymbolTable, names: set[str]) -> None:
        top = table.get_type() == "module"
        names |= {s.get_name() for s in table.get_symbols() if s.is_referenced() and (top or s.is_global())}
        for child in table.get_children():
            at_once = child.get_type() == "class" or child.get_name() in _AT_ONCE
            look(child, names if at_once else later)

    look(symtable.symtable(text, "cell", "exec"), now)
    return frozenset(now), frozenset(later)
