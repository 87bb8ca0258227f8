"""Wrong and right changes of a solution, packed into few notebooks, and what must come of each."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from course_lib.authoring.answers import Answers, Variant, changed
from course_lib.authoring.flaw import Flaw
from course_lib.authoring.mutants import Operator, mutants
from course_lib.authoring.rehearsal import Rehearsal
from course_lib.errors import CourseError, place_of
from course_lib.grading.advice import Advice
from course_lib.grading.judge import TaskResult
from course_lib.grading.task import Task

Look = Callable[[TaskResult], Iterable[Flaw]]


@dataclass(frozen=True)
class Edit:
    """A change of the solution of one task.

    Args:
        task: The task's id.
        name: For people.
        cells: What the cells are then, by their places.
        hidden: Whether the hidden scenarios are run.
        look: Returns what is wrong with the result.
        is_right: Whether it is another right answer.
    """

    task: str
    name: str
    cells: Mapping[int, str]
    hidden: bool
    look: Look
    is_right: bool = False


def said(result: TaskResult, *, hidden: bool | None = None) -> str:
    """Return all messages, or what they raised, and kinds of mistake of the checks that failed."""
    failed = [c for c in result.checks if not c.passed and hidden in (None, c.hidden)]
    return "\n".join(f"{check.broken or check.message}\n{check.mistake}" for check in failed)


def packed(edits: Iterable[Edit], cells: Sequence[str], week: str) -> list[tuple[list[Edit], Rehearsal]]:
    """Return notebooks in which several tasks are changed, each in other cells."""
    rounds: list[list[Edit]] = []
    for edit in edits:
        for one in rounds:
            if _fits(edit, one):
                one.append(edit)
                break
        else:
            rounds.append([edit])
    return [(one, rehearsal_of(one, cells, week)) for one in rounds]


def _fits(edit: Edit, others: Sequence[Edit]) -> bool:
    taken = {place for other in others for place in other.cells}
    tasks = {other.task for other in others}
    return others[0].hidden == edit.hidden and edit.task not in tasks and not taken & edit.cells.keys()


def rehearsal_of(edits: Sequence[Edit], cells: Sequence[str], week: str) -> Rehearsal:
    """Return the solution with all these changes."""
    new = {place: text for edit in edits for place, text in edit.cells.items()}
    code = tuple(new.get(place, cell) for place, cell in enumerate(cells))
    names = ", ".join(edit.name for edit in edits)
    return Rehearsal(week, names, code, tuple(edit.task for edit in edits), edits[0].hidden)


def edits_of(
    tasks: Sequence[Task], answers: Answers, cells: Sequence[str], among: Sequence[Operator]
) -> Iterator[Edit | Flaw]:
    """Yield every variant and every mutant of the solution; a flaw for one that can't be made."""
    by_id = {task.id: task for task in tasks}
    for variant in answers.variants:
        place = place_of(answers.path, variant.miss or variant.way)
        if variant.task not in by_id:
            yield Flaw("wrong", f"there is no task {variant.task!r}, known: {', '.join(by_id)}", place)
            continue
        yield _variant_edit(variant, by_id[variant.task], place, cells)
    for unknown in answers.same.keys() - by_id.keys():
        text = f"[same]: there is no task {unknown!r}, known: {', '.join(by_id)}"
        yield Flaw("wrong", text, str(answers.path))
    for task in tasks:
        same = answers.same.get(task.id, ())
        made = list(_mutant_edits(task, cells, among, answers.path))
        yield from (edit for operator, edit in made if operator.name not in same)
        for name in set(same) - {operator.name for operator, _ in made}:
            text = f"[same] {task.id.split('.')[1]}: no mutant {name!r} is made of it: leave it out"
            yield Flaw("wrong", text, place_of(answers.path, name))


def _variant_edit(variant: Variant, task: Task, place: str, cells: Sequence[str]) -> Edit | Flaw:
    name = f"{variant.task}: {variant.miss or variant.way}"
    try:
        new = changed(variant, task.name, cells)
    except CourseError as error:
        return Flaw("wrong" if variant.miss else "second", f"{name}: {error}", place)
    look = partial(_missed, variant, task, place) if variant.miss else partial(_full, variant, place)
    return Edit(variant.task, name, new, bool(variant.way), look, is_right=bool(variant.way))


def _missed(variant: Variant, task: Task, place: str, result: TaskResult) -> Iterator[Flaw]:
    """Yield what is wrong where a public check should have named the missed requirement."""
    name = f"{variant.task}: {variant.miss}"
    raised = [error.split(":")[0] for error in result.errors]
    if raised != [variant.raises] * bool(variant.raises):
        expected = variant.raises or "no exception"
        yield Flaw(
            "wrong", f"{name}: the code raises {result.errors[:1] or 'nothing'}, expected {expected}", place
        )
    elif not re.search(variant.says, said(result)):
        came = said(result).splitlines()[:1] or ["all public checks pass"]
        yield Flaw(
            "wrong", f"{name}: expected a message with {variant.says!r}, the checks say: {came[0]}", place
        )
    elif variant.hint:
        shown, own = Advice().hint(task, result), task.mistakes.get(variant.hint, "")
        if shown != f"Hint: {own}":
            yield Flaw(
                "wrong",
                f"{name}: the hint shown first is {shown!r}, expected that of {variant.hint!r}",
                place,
            )


def _full(variant: Variant, place: str, result: TaskResult) -> Iterator[Flaw]:
    """Yield what is wrong where another right solution has not full marks."""
    if result.score != result.points:
        why = (said(result).splitlines() or list(result.errors) or ["nothing is said"])[0]
        yield Flaw(
            "second",
            f"{variant.task}: {variant.way}: {result.score:g} of {result.points:g} points: {why}",
            place,
        )


def _mutant_edits(
    task: Task, cells: Sequence[str], among: Sequence[Operator], path: Path
) -> Iterator[tuple[Operator, Edit]]:
    defined = re.compile(rf"^(class|def) {task.name}\b", re.MULTILINE)
    place = next((i for i, cell in enumerate(cells) if defined.search(cell)), None)
    if place is None:
        return  # a value, a text: its wrong answers are in the week's file
    for operator, code in mutants(cells[place], among):
        name = f"{task.id}: mutant {operator.name!r}"
        yield operator, Edit(task.id, name, {place: code}, True, partial(_caught, operator, name, path))


def _caught(operator: Operator, name: str, path: Path, result: TaskResult) -> Iterator[Flaw]:
    """Yield what is wrong where the checks should have named a mutant's mistake."""
    missed = [
        *["it raises an exception"] * bool(result.errors),
        *["it has full marks"] * (result.score >= result.points),
        *["the hidden checks pass it"] * (not said(result, hidden=True)),
        *["the public checks pass it"] * (not operator.only_other_inputs and not said(result, hidden=False)),
    ]
    if missed:
        row = f"[same] {result.task.split('.')[1]} = [{operator.name!r}]"
        also = f"Mend the check; or, if that changes nothing required, write into {path.name}: {row}"
        yield Flaw("wrong", f"{name}: {', '.join(missed)}. {also}", str(path))
    elif not re.search(operator.names, said(result)):
        came = said(result).splitlines()[0]
        yield Flaw("wrong", f"{name}: expected {operator.names!r}, the checks say: {came}", str(path))
