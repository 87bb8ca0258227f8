"""Wrong and right variants of a solution, combined into few notebooks, and their expected results.

Deletions are variants too. A check that only inspects an answer, or calls too little of it,
passes answers that crash when they are used. Such answers are generated, because authors would
miss some. Each statement of a correct answer is replaced by `pass`, and each imported name is
removed, including those in strings that contain a program, like launch files. An answer crashes
if a public or a hidden scenario raises an exception, or if it refers to a name or to an attribute
of `self` that is no longer defined. Python detects the latter only when that line runs.
"""

import ast
import builtins
import copy
import re
import tomllib
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial
from itertools import accumulate
from pathlib import Path
from typing import Any

from course_lib.authoring.rehearsal import Rehearsal, RehearsalResult, cells_of
from course_lib.authoring.rules import Flaw
from course_lib.errors import CourseError, location_of
from course_lib.grading.advice import Advice, hints_by_mistake
from course_lib.grading.records import TaskResult
from course_lib.grading.submissions.notebook import CodeCell
from course_lib.grading.task import Task
from course_lib.third_party import parse_scopes


@dataclass(frozen=True)
class Operator:
    """A mutation operator: a kind of mistake. Each match of the pattern produces one mutant.

    Args:
        name: Name of the operator.
        pattern: Regular expression for the code to replace.
        replacement: The replacement, which may refer to groups of the pattern.
        names: Regular expression that a message or a kind of mistake of a failed check must match.
        only_other_inputs: Whether the mutant is correct for the inputs of the public scenario.
    """

    name: str
    pattern: str
    replacement: str
    names: str
    only_other_inputs: bool = False


def operators(solutions: Path) -> tuple[Operator, ...]:
    """Return the general operators and the operators in the course's `answers/mutants.toml`.

    Raises:
        CourseError: The file is malformed.
    """
    return (*_read(Path(__file__).with_name("mutants.toml")), *_course_operators(solutions))


def idle_operators(solutions: Path, cells: Sequence[str]) -> Iterator[str]:
    """Yield the names of the course's own operators that do not match any cell."""
    for operator in _course_operators(solutions):
        if not any(re.search(operator.pattern, cell) for cell in cells):
            yield operator.name


def mutants(code: str, operators: Iterable[Operator]) -> Iterator[tuple[Operator, str]]:
    """Yield (operator, mutated code) for each match of an operator."""
    for operator in operators:
        for match in re.finditer(operator.pattern, code):
            yield operator, code[: match.start()] + match.expand(operator.replacement) + code[match.end() :]


def _course_operators(solutions: Path) -> tuple[Operator, ...]:
    path = solutions / "answers" / "mutants.toml"
    return _read(path) if path.is_file() else ()


def _read(path: Path) -> tuple[Operator, ...]:
    try:
        rows = tomllib.loads(path.read_text(encoding="utf-8")).get("mutant", [])
        operators = tuple(Operator(**row) for row in rows)
        for operator in operators:
            re.compile(operator.names)
            # Raise an error for an invalid pattern, or an invalid group reference in the
            # replacement.
            re.sub(operator.pattern, operator.replacement, "")
    except (TypeError, ValueError, LookupError, re.error) as error:
        raise CourseError(
            f"{path}: {error}; expected [[mutant]] with name, pattern, replacement, names"
        ) from error
    return operators


# File name suffix of alternative correct answers to all tasks.
RIGHT = "other_right"


@dataclass(frozen=True)
class Variant:
    """The solution of a task with changes: a row of the week's answers file.

    Args:
        task: The task's id.
        change: Pairs (old, new) of text to replace in the solution.
        miss: Description of the requirement that a wrong answer does not meet.
        says: Regular expression that a message of a public check must match.
        raises: Name of the exception that the wrong answer raises, or "".
        way: Description of how a correct answer differs from the solution.
        hint: The kind of mistake whose hint, defined by the task, must be shown first.
    """

    task: str
    change: tuple[tuple[str, str], ...]
    miss: str = ""
    says: str = ""
    raises: str = ""
    way: str = ""
    hint: str = ""

    def __post_init__(self) -> None:
        if bool(self.miss) == bool(self.way):
            raise CourseError("expected either miss (a wrong answer) or way (a right one)")
        if self.miss and not (self.says or self.raises):
            raise CourseError(
                f"{self.miss!r}: expected the key says with a pattern for the message of a public check"
            )
        try:
            re.compile(self.says)
        except re.error as error:
            raise CourseError(f"says: {self.says!r} is not a regular expression: {error}") from error
        if not self.change or not all(len(pair) == 2 for pair in self.change):
            raise CourseError("change: expected pairs of old and new text, [[old, new]]")


@dataclass(frozen=True)
class Answers:
    """The right and wrong answers of a week.

    Args:
        path: The week's answers file.
        variants: The variants of the solution in it.
        files: The expected message by task id, for each Python file of wrong answers.
        same: By task id, the operators whose mutants still meet the requirements.
    """

    path: Path
    variants: tuple[Variant, ...] = ()
    files: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    same: Mapping[str, Sequence[str]] = field(default_factory=dict)

    @property
    def other_right(self) -> Path | None:
        """The file of alternative correct answers, or None."""
        path = self.file(RIGHT)
        return path if path.is_file() else None

    def file(self, name: str) -> Path:
        """Return the path of a Python file of answers."""
        return self.path.with_name(f"{self.path.stem}_{name}.py")

    def count_wrong_answers(self, task: str) -> int:
        """Return the number of wrong answers to a task."""
        return sum(v.task == task and bool(v.miss) for v in self.variants) + sum(
            task in says for says in self.files.values()
        )


def read_answers(solutions: Path, week: str) -> Answers:
    """Read a week's answers. Return empty `Answers` if there is no file.

    Raises:
        CourseError: The file is malformed. The message contains the path, and the line if known.
    """
    path = solutions / "answers" / f"{week}.toml"
    if not path.is_file():
        return Answers(path)
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise CourseError(f"{path}: {error}") from error
    files = {name: _prefix_with_week(week, says) for name, says in tables.pop("files", {}).items()}
    same = _prefix_with_week(week, tables.pop("same", {}))
    rows = [(f"{week}.{name}", row) for name, table in tables.items() for row in table]
    return Answers(path, tuple(_variant(path, task, row) for task, row in rows), files, same)


def _prefix_with_week(week: str, table: Mapping[str, Any]) -> dict[str, Any]:
    return {f"{week}.{name}": value for name, value in table.items()}


def _variant(path: Path, task: str, row: Any) -> Variant:
    try:
        pairs = tuple(tuple(pair) for pair in row.get("change", ()))
        return Variant(task, **{**row, "change": pairs})
    except (AttributeError, TypeError, CourseError) as error:
        task_of_row = next(iter(row.values()), task) if isinstance(row, dict) else task
        raise CourseError(f"{location_of(path, str(task_of_row))}: {task}: {error}") from error


def apply_changes(variant: Variant, name: str, cells: Sequence[str]) -> dict[int, str]:
    """Apply a variant's changes to the solution, and return the changed cells by index.

    Args:
        variant: The variant.
        name: The name of the task's object. Only cells with this name are changed.
        cells: The cells of the solution.

    Raises:
        CourseError: A text to replace does not occur exactly once in exactly one of these cells.
    """
    changed_cells: dict[int, str] = {}
    for old, new in variant.change:
        if old == new:
            raise CourseError(f"{old!r} is replaced by itself")
        now = [changed_cells.get(place, cell) for place, cell in enumerate(cells)]
        there = [i for i, cell in enumerate(now) if old in cell and re.search(rf"\b{name}\b", cell)]
        if len(there) != 1:
            raise CourseError(f"{old!r} is in {len(there)} cells of the solution with {name}, expected 1")
        if (count := now[there[0]].count(old)) != 1:
            more = "include more of its line in the pair"
            raise CourseError(f"{old!r} occurs {count} times in the cell with {name}, expected once: {more}")
        changed_cells[there[0]] = now[there[0]].replace(old, new)
    return changed_cells


Look = Callable[[TaskResult], Iterable[Flaw]]


@dataclass(frozen=True)
class Edit:
    """A change to one task's solution.

    Args:
        task: The task's id.
        name: A description for messages.
        cells: The changed cells by index.
        hidden: Whether the hidden scenarios are run.
        look: Returns the flaws in the task's result.
        is_right: Whether it is an alternative correct answer.
    """

    task: str
    name: str
    cells: Mapping[int, str]
    hidden: bool
    look: Look
    is_right: bool = False


def failure_text(result: TaskResult, *, hidden: bool | None = None) -> str:
    """Return the messages (or exceptions) of the failed checks, and their kinds of mistake."""
    failed = [c for c in result.checks if not c.passed and hidden in (None, c.hidden)]
    return "\n".join(f"{check.broken or check.message}\n{check.mistake}" for check in failed)


def group_edits(
    edits: Iterable[Edit],
    cells: Sequence[str],
    week: str,
) -> list[tuple[list[Edit], Rehearsal]]:
    """Combine edits of different tasks and different cells into few notebooks."""
    rounds: list[list[Edit]] = []
    for edit in edits:
        for round_ in rounds:
            edited_cells = {place for other in round_ for place in other.cells}
            tasks = {other.task for other in round_}
            if (
                round_[0].hidden == edit.hidden
                and edit.task not in tasks
                and not edited_cells & edit.cells.keys()
            ):
                round_.append(edit)
                break
        else:
            rounds.append([edit])
    return [(edits, make_rehearsal(edits, cells, week)) for edits in rounds]


def make_rehearsal(edits: Sequence[Edit], cells: Sequence[str], week: str) -> Rehearsal:
    """Return the rehearsal of the solution with these edits."""
    new = {place: text for edit in edits for place, text in edit.cells.items()}
    code = tuple(new.get(place, cell) for place, cell in enumerate(cells))
    names = ", ".join(edit.name for edit in edits)
    return Rehearsal(week, names, code, tuple(edit.task for edit in edits), edits[0].hidden)


def make_edits(
    tasks: Sequence[Task], answers: Answers, cells: Sequence[str], operators: Sequence[Operator]
) -> Iterator[Edit | Flaw]:
    """Yield the edits of all variants and mutants of the solution, and flaws for inapplicable ones."""
    by_id = {task.id: task for task in tasks}
    for variant in answers.variants:
        place = location_of(answers.path, variant.miss or variant.way)
        if variant.task not in by_id:
            yield Flaw("wrong", f"there is no task {variant.task!r}, known: {', '.join(by_id)}", place)
            continue
        yield _variant_edit(variant, by_id[variant.task], place, cells)
    for unknown in answers.same.keys() - by_id.keys():
        text = f"[same]: there is no task {unknown!r}, known: {', '.join(by_id)}"
        yield Flaw("wrong", text, str(answers.path))
    for task in tasks:
        same = answers.same.get(task.id, ())
        mutants = list(_mutant_edits(task, cells, operators, answers.path))
        yield from (edit for operator, edit in mutants if operator.name not in same)
        for name in set(same) - {operator.name for operator, _ in mutants}:
            text = f"[same] {task.id.split('.')[1]}: the task has no mutant {name!r}: remove it"
            yield Flaw("wrong", text, location_of(answers.path, name))


def _variant_edit(variant: Variant, task: Task, place: str, cells: Sequence[str]) -> Edit | Flaw:
    name = f"{variant.task}: {variant.miss or variant.way}"
    try:
        new = apply_changes(variant, task.name, cells)
    except CourseError as error:
        return Flaw("wrong" if variant.miss else "second", f"{name}: {error}", place)
    look = (
        partial(_check_wrong_answer, variant, task, place)
        if variant.miss
        else partial(_check_right_answer, variant, place)
    )
    return Edit(variant.task, name, new, bool(variant.way), look, is_right=bool(variant.way))


def _check_wrong_answer(
    variant: Variant,
    task: Task,
    place: str,
    result: TaskResult,
) -> Iterator[Flaw]:
    """Yield a flaw if no public check reports the requirement that a wrong answer misses."""
    name = f"{variant.task}: {variant.miss}"
    raised = [error.split(":")[0] for error in result.errors]
    if raised != [variant.raises] * bool(variant.raises):
        expected = variant.raises or "no exception"
        yield Flaw(
            "wrong", f"{name}: the code raises {result.errors[:1] or 'nothing'}, expected {expected}", place
        )
    elif not re.search(variant.says, failure_text(result)):
        reported = failure_text(result).splitlines()[:1] or ["all public checks pass"]
        yield Flaw(
            "wrong",
            f"{name}: expected a message with {variant.says!r}, the checks report: {reported[0]}",
            place,
        )
    elif variant.hint:
        first_hint, *_ = Advice().hint(task, result)
        expected_hint = task.mistakes.get(variant.hint) or hints_by_mistake().get(variant.hint)
        if first_hint != f"Hint: {expected_hint}":
            yield Flaw(
                "wrong",
                f"{name}: the hint shown first is {first_hint!r}, expected the hint of {variant.hint!r}",
                place,
            )


def _check_right_answer(variant: Variant, place: str, result: TaskResult) -> Iterator[Flaw]:
    """Yield a flaw if an alternative correct answer does not have full marks."""
    if result.score != result.points:
        why = (failure_text(result).splitlines() or list(result.errors) or ["nothing is said"])[0]
        yield Flaw(
            "second",
            f"{variant.task}: {variant.way}: {result.score:g} of {result.points:g} points: {why}",
            place,
        )


def _mutant_edits(
    task: Task, cells: Sequence[str], operators: Sequence[Operator], path: Path
) -> Iterator[tuple[Operator, Edit]]:
    defined = re.compile(rf"^(class|def) {task.name}\b", re.MULTILINE)
    place = next((i for i, cell in enumerate(cells) if defined.search(cell)), None)
    if place is None:
        # Answers that are values or strings are not mutated; their variants are in the week's file.
        return
    for operator, code in mutants(cells[place], operators):
        name = f"{task.id}: mutant {operator.name!r}"
        yield operator, Edit(task.id, name, {place: code}, True, partial(_check_mutant, operator, name, path))


def _check_mutant(operator: Operator, name: str, path: Path, result: TaskResult) -> Iterator[Flaw]:
    """Yield a flaw if the checks do not report the mistake of a mutant."""
    missed = [
        *["it raises an exception"] * bool(result.errors),
        *["it has full marks"] * (result.score >= result.points),
        *["the hidden checks pass it"] * (not failure_text(result, hidden=True)),
        *["the public checks pass it"]
        * (not operator.only_other_inputs and not failure_text(result, hidden=False)),
    ]
    if missed:
        row = f"[same] {result.task.split('.')[1]} = [{operator.name!r}]"
        also = f"Fix the check or, if the mutant meets the requirements, add to {path.name}: {row}"
        yield Flaw("wrong", f"{name}: {', '.join(missed)}. {also}", str(path))
    elif not re.search(operator.names, failure_text(result)):
        reported = failure_text(result).splitlines()[0]
        yield Flaw("wrong", f"{name}: expected {operator.names!r}, the checks report: {reported}", str(path))


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
    """The code cells of an answer, and which of their statements each task needs."""

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
            check_argument = _cell(cell).checks.get(task.id)
            pending_names |= _names(check_argument) if check_argument is not None else set()
        while pending_names:
            visited_names |= pending_names
            new = {key for key, s in self.statements.items() if s.provided & pending_names} - keys
            keys |= new
            pending_names = {name for key in new for name in self.statements[key].names} - visited_names
        return frozenset(keys)

    def with_cell(self, index: int, code: str) -> "Code":
        """Return a copy in which one cell is replaced."""
        return Code((*self.cells[:index], code, *self.cells[index + 1 :]))

    def undefined_names(self, keys: Iterable[Key]) -> set[str]:
        """Return the names that these statements refer to and that no cell binds."""
        defined_names = ALWAYS_DEFINED.union(*(s.provided for s in self.statements.values()))
        return {name for key in keys for name in self.statements.get(key, NOTHING).names} - defined_names

    def undefined_attributes(self, keys: Iterable[Key], attributes: Iterable[str]) -> set[str]:
        """Return the members of `attributes` that these statements read and never assign."""
        statements = [self.statements.get(key, NOTHING) for key in keys]
        read_attributes = {name for statement in statements for name in statement.read_attributes}
        return read_attributes.intersection(attributes).difference(*(s.assigned for s in statements))


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
    return tuple(map(_statement, _tree(source).body))


def _statement(node: ast.stmt) -> _Statement:
    code = ast.unparse(node)
    attributes = [part for part in ast.walk(node) if isinstance(part, ast.Attribute)]
    definitions = {part.name for part in ast.walk(node) if isinstance(part, ast.FunctionDef | ast.ClassDef)}
    return _Statement(
        _cell(code).bindings,
        _global_names(code),
        frozenset(part.attr for part in attributes if isinstance(part.ctx, ast.Load)),
        frozenset({part.attr for part in attributes if not isinstance(part.ctx, ast.Load)} | definitions),
    )


def deletions(code: Code, tasks: Sequence[Task]) -> Iterator[Deletion]:
    """Yield all deletions in the statements that the tasks need."""
    needed_keys = {task.id: code.required_statements(task) for task in tasks}
    for index, source in enumerate(code.cells):
        tree = _tree(source)
        for number, statement in enumerate(tree.body):
            key = (index, number)
            of = tuple(task for task, keys in needed_keys.items() if key in keys)
            for part in _deletable_parts(source, statement) if of else ():
                text = source[: part.first] + part.replacement + source[part.last :]
                if _cell(text).syntax_error:
                    continue
                less = code.with_cell(index, text)
                static = {task: _static_crash(code, less, needed_keys[task], part.attributes) for task in of}
                yield Deletion(f"without {part.name}", index, text, of, static, key)


def _static_crash(code: Code, less: Code, keys: Iterable[Key], attributes: Iterable[str]) -> str:
    if names := less.undefined_names(keys) - code.undefined_names(keys):
        return f"name {sorted(names)[0]!r} is not defined"
    if missing := less.undefined_attributes(keys, attributes):
        return f"nothing assigns self.{sorted(missing)[0]}"
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
    groups: list[list[Deletion]] = []
    for deletion in deletions:
        for group in groups:
            if not any(_conflict(deletion, other, needed_keys) for other in group):
                group.append(deletion)
                break
        else:
            groups.append([deletion])
    return groups


def _conflict(deletion: Deletion, other: Deletion, needed_keys: Mapping[str, frozenset[Key]]) -> bool:
    return (
        deletion.cell == other.cell
        or bool({*deletion.tasks} & {*other.tasks})
        or any(other.statement in needed_keys[task] for task in deletion.tasks)
        or any(deletion.statement in needed_keys[task] for task in other.tasks)
    )


def rehearsal_without(
    group: Sequence[Deletion],
    code: Code,
    week: str,
    *,
    hidden: bool = True,
) -> Rehearsal:
    """Return the rehearsal of the answer with all deletions of a group."""
    remaining_code = code
    for deletion in group:
        remaining_code = remaining_code.with_cell(deletion.cell, deletion.code)
    tasks = tuple(task for deletion in group for task in deletion.tasks)
    return Rehearsal(week, ", ".join(row.name for row in group), remaining_code.cells, tasks, hidden)


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
    public = run([rehearsal_without(group, code, week, hidden=False) for group in groups])
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
    public = [check for check in result.checks if not check.hidden]
    return bool(public) and all(check.passed for check in public) and not result.is_untouched


def _names(tree: ast.AST) -> set[str]:
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}


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


def _deletable_parts(source: str, tree: ast.AST) -> Iterator[_DeletablePart]:
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
        if isinstance(node, ast.stmt) and not _changes_nothing(node, source[first:last]):
            for decorator in getattr(node, "decorator_list", ()):
                first = min(first, offset(decorator.lineno, decorator.col_offset) - 1)
            text = " ".join(source[first:last].split())
            shown = text if len(text) <= EXCERPT_LENGTH else f"{text[:EXCERPT_LENGTH]}…"
            yield _DeletablePart(repr(shown), first, last, "pass", frozenset(_assigned_attributes(node)))
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
        for part in _deletable_parts(code, tree):
            yield replace(
                part, name=f"{part.name} in the text", first=begin + part.first, last=begin + part.last
            )


def _changes_nothing(node: ast.stmt, text: str) -> bool:
    """Return whether a statement is a docstring, `pass`, or a magic."""
    is_text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    return is_text or isinstance(node, ast.Pass) or text.lstrip()[:1] in ("%", "!", "")


def _assigned_attributes(node: ast.stmt) -> Iterator[str]:
    """Yield the attributes of `self` that a statement assigns."""
    for part in ast.walk(node):
        match part:
            case ast.Attribute(value=ast.Name(id="self"), attr=name, ctx=ast.Store()):
                yield name
