"""Correct answers with one statement or imported name deleted. None may pass if it crashes.

A check that only inspects an answer, or calls too little of it, passes answers that crash when they
are used. Such answers are generated, because authors would miss some. Each statement of a correct
answer is replaced by `pass`, and each imported name is removed, including those in strings that
contain a program, like launch files. An answer crashes if a public or a hidden scenario raises an
exception, or if it refers to a name or to an attribute of `self` that is no longer defined. Python
detects the latter only when that line runs.
"""

import ast
import builtins
import copy
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import accumulate
from pathlib import Path

from course_lib.authoring.rehearsal import Rehearsal, RehearsalResult, cells_of
from course_lib.grading.records import TaskResult
from course_lib.grading.submissions.notebook import CodeCell
from course_lib.grading.task import Task
from course_lib.third_party import parse_scopes

# Replacement fields of an f-string.
PLACEHOLDER = re.compile(r"\{[^{}]*\}")
LONG_STRING = re.compile(r"(?P<prefix>[a-zA-Z]*)(?P<quotes>\"{3}|'{3})(?P<text>.*)(?P=quotes)", re.DOTALL)
ALWAYS_DEFINED = {*dir(builtins), "get_ipython", "__name__", "__file__"}
ENDS = (ast.Return, ast.Raise, ast.Break, ast.Continue)
# Kinds of mistake that count as a crash.
LAUNCH_ERRORS = {"ros2 launch ends with an error", "a node of the launch file ends with an error"}
# Maximum number of characters that a message shows of a deleted statement.
EXCERPT_LENGTH = 60


@dataclass(frozen=True)
class Deletion:
    """A cell of a correct answer from which a statement or an imported name was deleted.

    Args:
        name: Description of the deleted code, for messages.
        cell: The index of the cell.
        code: The cell after the deletion.
        tasks: The ids of the tasks that need the changed top-level statement.
        crashes: By task, the exception that static analysis predicts, or "".
        statement: The key of the changed top-level statement.
    """

    name: str
    cell: int
    code: str
    tasks: tuple[str, ...]
    crashes: Mapping[str, str]
    statement: "Key"


# Identifies a statement: the cell, and the index among the cell's statements.
Key = tuple[int, int]


@dataclass(frozen=True)
class _Statement:
    """The names and attributes that a top-level statement of a cell defines and uses."""

    # Names that the statement binds, and global names that it refers to.
    provided: frozenset[str]
    names: frozenset[str]
    # Attributes that the statement reads, and attributes that it assigns or defines as methods or
    # nested classes.
    read_attributes: frozenset[str]
    assigned: frozenset[str]


@dataclass(frozen=True)
class Code:
    """The code cells of an answer, and the statements that each task depends on."""

    cells: tuple[str, ...]

    @classmethod
    def from_notebook(cls, path: Path) -> "Code":
        """Read a notebook, or a Python file."""
        return cls(cells_of(path))

    @cached_property
    def statements(self) -> dict[Key, _Statement]:
        """All top-level statements of the cells."""
        return {(c, n): part for c, cell in enumerate(self.cells) for n, part in enumerate(_statements(cell))}

    def required_statements(self, task: Task) -> frozenset[Key]:
        """Return the statements that a task's object depends on."""
        visited_names, pending_names, keys = set[str](), {task.name}, set[Key]()
        for cell in self.cells:
            if (argument := _cell(cell).checks.get(task.id)) is not None:
                pending_names |= {node.id for node in ast.walk(argument) if isinstance(node, ast.Name)}
        while pending_names:
            visited_names |= pending_names
            new = {key for key, s in self.statements.items() if s.provided & pending_names} - keys
            keys |= new
            pending_names = {name for key in new for name in self.statements[key].names} - visited_names
        return frozenset(keys)

    def with_cell(self, index: int, code: str) -> "Code":
        """Return a copy in which one cell is replaced."""
        return Code((*self.cells[:index], code, *self.cells[index + 1 :]))


NOTHING = _Statement(frozenset(), frozenset(), frozenset(), frozenset())


@lru_cache(maxsize=4000)
def _cell(source: str) -> CodeCell:
    return CodeCell(1, source, True)


@lru_cache(maxsize=4000)
def _tree(source: str) -> ast.Module:
    """Return the syntax tree without unreachable code after a return, raise, break or continue."""
    tree = copy.deepcopy(_cell(source).tree)
    for node in ast.walk(tree):
        for name, body in ast.iter_fields(node):
            if name in ("body", "orelse", "finalbody") and isinstance(body, list):
                ends = [n for n, statement in enumerate(body) if isinstance(statement, ENDS)]
                del body[ends[0] + 1 if ends else len(body) :]
    return tree


@lru_cache(maxsize=4000)
def _statements(source: str) -> tuple[_Statement, ...]:
    found = []
    for node in _tree(source).body:
        code, parts = ast.unparse(node), list(ast.walk(node))
        attributes = [part for part in parts if isinstance(part, ast.Attribute)]
        read_attributes = frozenset(part.attr for part in attributes if isinstance(part.ctx, ast.Load))
        assigned = {part.attr for part in attributes if not isinstance(part.ctx, ast.Load)}
        assigned |= {part.name for part in parts if isinstance(part, ast.FunctionDef | ast.ClassDef)}
        names = _global_names(code)
        found.append(_Statement(_cell(code).bindings, names, read_attributes, frozenset(assigned)))
    return tuple(found)


def deletions(code: Code, tasks: Sequence[Task]) -> Iterator[Deletion]:
    """Yield all deletions in the statements that the tasks need."""
    needed_keys = {task.id: code.required_statements(task) for task in tasks}
    for index, source in enumerate(code.cells):
        tree = _tree(source)
        for number, statement in enumerate(tree.body):
            key = (index, number)
            of = tuple(task for task, keys in needed_keys.items() if key in keys)
            for part in _find_deletable(source, statement) if of else ():
                text = source[: part.first] + part.replacement + source[part.last :]
                if _cell(text).syntax_error:
                    continue
                less = code.with_cell(index, text)
                crashes = {
                    task: _predict_crash(code, less, needed_keys[task], part.attributes) for task in of
                }
                yield Deletion(f"without {part.name}", index, text, of, crashes, key)


def _predict_crash(code: Code, less: Code, keys: Iterable[Key], attributes: Iterable[str]) -> str:
    """Return the exception that a deletion causes, as far as the code shows it, or "".

    Args:
        code: The code before the deletion.
        less: The code after it.
        keys: The statements that the task needs.
        attributes: The attributes of `self` that the deleted statement assigns.
    """
    undefined = []
    for part in (less, code):
        bound = ALWAYS_DEFINED.union(*(s.provided for s in part.statements.values()))
        undefined.append({n for key in keys for n in part.statements.get(key, NOTHING).names} - bound)
    if names := undefined[0] - undefined[1]:
        return f"name {min(names)!r} is not defined"
    needed = [less.statements.get(key, NOTHING) for key in keys]
    read = {name for statement in needed for name in statement.read_attributes}
    if missing := read.intersection(attributes).difference(*(s.assigned for s in needed)):
        return f"nothing assigns self.{min(missing)}"
    return ""


def group_deletions(
    deletions: Iterable[Deletion],
    code: Code,
    tasks: Sequence[Task],
) -> list[list[Deletion]]:
    """Group deletions that can be run together.

    They are in different cells, and no task of one needs a statement that another one changes.
    """
    needed_keys = {task.id: code.required_statements(task) for task in tasks}

    def conflicts(deletion: Deletion, other: Deletion) -> bool:
        return (
            deletion.cell == other.cell
            or bool({*deletion.tasks} & {*other.tasks})
            or any(other.statement in needed_keys[task] for task in deletion.tasks)
            or any(deletion.statement in needed_keys[task] for task in other.tasks)
        )

    groups: list[list[Deletion]] = []
    for deletion in deletions:
        for group in groups:
            if not any(conflicts(deletion, other) for other in group):
                group.append(deletion)
                break
        else:
            groups.append([deletion])
    return groups


def rehearsal_without(
    group: Sequence[Deletion],
    code: Code,
    week: str,
    *,
    with_hidden: bool = True,
) -> Rehearsal:
    """Return the rehearsal of the answer with all deletions of a group."""
    remaining_code = code
    for deletion in group:
        remaining_code = remaining_code.with_cell(deletion.cell, deletion.code)
    tasks = tuple(task for deletion in group for task in deletion.tasks)
    name = ", ".join(row.name for row in group)
    return Rehearsal(week, name, remaining_code.cells, tasks, with_hidden)


def crash_message(deletion: Deletion, result: TaskResult, tracebacks: Collection[str] = ()) -> str:
    """Return why an answer crashes, or "" if it does not.

    Args:
        deletion: The deletion in the answer.
        result: The result of one of the deletion's tasks.
        tracebacks: The tasks whose code printed a traceback.
    """
    launch_errors = (
        check.message for check in result.checks if not LAUNCH_ERRORS.isdisjoint(check.mistake.split("; "))
    )
    printed = "it prints the traceback of an exception" if result.task in tracebacks else ""
    return next(iter((*result.errors, *launch_errors)), "") or printed or deletion.crashes[result.task]


def find_false_passes(
    code: Code,
    tasks: Sequence[Task],
    week: str,
    run: Callable[[Sequence[Rehearsal]], Iterable[RehearsalResult]],
) -> Iterator[tuple[str, str, str]]:
    """Yield (deletion, task, exception) for each crashing answer that passes all public checks.

    Args:
        code: The correct answer.
        tasks: The tasks that it solves.
        week: The week of the tasks.
        run: Runs rehearsals and returns their results in order.
    """
    # Most deletions fail a public check. The hidden scenarios, about half of all, are run only for
    # the others.
    groups = group_deletions(deletions(code, tasks), code, tasks)
    public = run([rehearsal_without(group, code, week, with_hidden=False) for group in groups])
    passing = []
    for group, result in zip(groups, public, strict=True):
        passed_tasks = {task.task for task in result.results if passes_public_checks(task)}
        passing += [deletion for deletion in group if not passed_tasks.isdisjoint(deletion.tasks)]
    groups = group_deletions(passing, code, tasks)
    complete = run([rehearsal_without(group, code, week) for group in groups])
    for group, result in zip(groups, complete, strict=True):
        yield from false_passes(group, result)


def false_passes(
    group: Sequence[Deletion], rehearsal_result: RehearsalResult
) -> Iterator[tuple[str, str, str]]:
    """Yield (deletion, task, exception) for each crashing answer that passes all public checks."""
    results = {result.task: result for result in rehearsal_result.results}
    for deletion in group:
        for task in deletion.tasks:
            why = crash_message(deletion, results[task], rehearsal_result.tracebacks)
            if why and passes_public_checks(results[task]):
                yield deletion.name, task, why


def passes_public_checks(result: TaskResult) -> bool:
    """Return whether all public checks pass."""
    public = [check for check in result.checks if not check.is_hidden]
    return bool(public) and all(check.passed for check in public) and not result.is_untouched


@lru_cache(maxsize=1000)
def _global_names(code: str) -> frozenset[str]:
    """Return the global names that code refers to, in any scope."""
    names, waiting = set[str](), [parse_scopes(code)]
    while waiting:
        table = waiting.pop()
        waiting += table.get_children()
        is_module = table.get_type() == "module"
        symbols = table.get_symbols()
        names |= {s.get_name() for s in symbols if s.is_referenced() and (is_module or s.is_global())}
    return frozenset(names)


@dataclass(frozen=True)
class _DeletablePart:
    """A deletable part of a program: its range in the source, and its replacement."""

    name: str
    first: int
    last: int
    replacement: str
    attributes: frozenset[str] = frozenset()


def _find_deletable(source: str, tree: ast.AST) -> Iterator[_DeletablePart]:
    """Yield the deletable imports and statements of a program and of programs in its strings."""
    lines = source.splitlines(keepends=True)
    starts = [0, *accumulate(len(line) for line in lines)]

    def offset(line: int, column: int) -> int:
        return starts[line - 1] + len(lines[line - 1].encode()[:column].decode())

    for node in ast.walk(tree):
        if (
            not isinstance(node, ast.stmt | ast.expr)
            or node.end_lineno is None
            or node.end_col_offset is None
        ):
            continue
        first, last = offset(node.lineno, node.col_offset), offset(node.end_lineno, node.end_col_offset)
        if isinstance(node, ast.Import | ast.ImportFrom) and len(node.names) > 1:
            for alias in node.names:
                other_aliases = [name for name in node.names if name is not alias]
                fewer = copy.copy(node)
                fewer.names = other_aliases
                yield _DeletablePart(f"import of {alias.name}", first, last, ast.unparse(fewer))
        is_docstring = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        is_magic = source[first:last].lstrip()[:1] in ("%", "!", "")
        changes_nothing = is_docstring or is_magic or isinstance(node, ast.Pass)
        if isinstance(node, ast.stmt) and not changes_nothing:
            for decorator in getattr(node, "decorator_list", ()):
                first = min(first, offset(decorator.lineno, decorator.col_offset) - 1)
            text = " ".join(source[first:last].split())
            shown = text if len(text) <= EXCERPT_LENGTH else f"{text[:EXCERPT_LENGTH]}…"
            assigned = frozenset(
                part.attr
                for part in ast.walk(node)
                if isinstance(part, ast.Attribute)
                and isinstance(part.ctx, ast.Store)
                and ast.unparse(part.value) == "self"
            )
            yield _DeletablePart(repr(shown), first, last, "pass", assigned)
        elif isinstance(node, ast.Constant | ast.JoinedStr):
            yield from _parts_in_string(source[first:last], first)


def _parts_in_string(literal: str, at: int) -> Iterator[_DeletablePart]:
    """Yield the parts of a program in a triple-quoted string, with placeholders read as numbers."""
    match = LONG_STRING.fullmatch(literal)
    if match is None:
        return
    code = match["text"]
    if "f" in match["prefix"].lower():
        code = PLACEHOLDER.sub(lambda placeholder: "1" * len(placeholder[0]), code)
    try:
        tree = ast.parse(code)
    except (SyntaxError, ValueError):
        return
    if any(isinstance(node, ast.Import | ast.ImportFrom | ast.FunctionDef) for node in tree.body):
        begin = at + match.start("text")
        for part in _find_deletable(code, tree):
            yield replace(
                part, name=f"{part.name} in the text", first=begin + part.first, last=begin + part.last
            )
