"""Wrong and right variants of a solution, combined into few notebooks, and their expected results."""

import re
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from course_lib.authoring.rehearsal import Rehearsal
from course_lib.authoring.rules import Flaw
from course_lib.errors import CourseError, location_of
from course_lib.grading.advice import Advice, hints_by_mistake
from course_lib.grading.records import TaskResult
from course_lib.grading.task import Task


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
    files = {
        name: {f"{week}.{task}": text for task, text in says.items()}
        for name, says in tables.pop("files", {}).items()
    }
    same = {f"{week}.{task}": names for task, names in tables.pop("same", {}).items()}
    variants = []
    for task, row in ((f"{week}.{name}", row) for name, table in tables.items() for row in table):
        try:
            pairs = tuple(tuple(pair) for pair in row.get("change", ()))
            variants.append(Variant(task, **{**row, "change": pairs}))
        except (AttributeError, TypeError, CourseError) as error:
            first_value = next(iter(row.values()), task) if isinstance(row, dict) else task
            raise CourseError(f"{location_of(path, str(first_value))}: {task}: {error}") from error
    return Answers(path, tuple(variants), files, same)


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
            raise CourseError(f"change: {old!r} is replaced by itself, expected a different new text")
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
        with_hidden: Whether the hidden scenarios are run.
        look: Returns the flaws in the task's result.
        is_right: Whether it is an alternative correct answer.
    """

    task: str
    name: str
    cells: Mapping[int, str]
    with_hidden: bool
    look: Look
    is_right: bool = False


def failure_text(result: TaskResult, *, is_hidden: bool | None = None) -> str:
    """Return the messages (or exceptions) of the failed checks, and their kinds of mistake."""
    failed = [c for c in result.checks if not c.passed and is_hidden in (None, c.is_hidden)]
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
                round_[0].with_hidden == edit.with_hidden
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
    return Rehearsal(week, names, code, tuple(edit.task for edit in edits), edits[0].with_hidden)


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
        name, task = f"{variant.task}: {variant.miss or variant.way}", by_id[variant.task]
        try:
            new = apply_changes(variant, task.name, cells)
        except CourseError as error:
            yield Flaw("wrong" if variant.miss else "second", f"{name}: {error}", place)
            continue
        look = (
            partial(_check_wrong_answer, variant, task, place)
            if variant.miss
            else partial(_check_right_answer, variant, place)
        )
        yield Edit(variant.task, name, new, bool(variant.way), look, is_right=bool(variant.way))
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
        *["the hidden checks pass it"] * (not failure_text(result, is_hidden=True)),
        *["the public checks pass it"]
        * (not operator.only_other_inputs and not failure_text(result, is_hidden=False)),
    ]
    if missed:
        row = f"[same] {result.task.split('.')[1]} = [{operator.name!r}]"
        also = f"Fix the check or, if the mutant meets the requirements, add to {path.name}: {row}"
        yield Flaw("wrong", f"{name}: {', '.join(missed)}. {also}", str(path))
    elif not re.search(operator.names, failure_text(result)):
        reported = failure_text(result).splitlines()[0]
        yield Flaw("wrong", f"{name}: expected {operator.names!r}, the checks report: {reported}", str(path))
