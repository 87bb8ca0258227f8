"""Submissions of a class, with expected results from the course's tables of right and wrong answers."""

import json
import random
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache

from course_lib.authoring.edits import apply_changes, mutants, operators, read_answers
from course_lib.course.exercise import exercise_path, read_notebook, source
from course_lib.course.material import solutions_dir
from course_lib.grading.task import Task
from tests.notebooks.graded import catalog, cells_of, solution

FULL, LESS, NOTHING, ANY = "full", "less", "nothing", "any"  # points of a task
GRADED, REJECTED, LIMIT, WAITS = "graded", "rejected", "limit", "needs_marking"
DEFINED = re.compile(r"^(?:class |def )?(\w+)(?=[(:]| =)", re.MULTILINE)
KINDS = (
    *("right",) * 26, *("way",) * 8, *("miss",) * 34, *("mutant",) * 14, *("try",) * 4, *("stub",) * 3,
    *("twin",) * 3, "copied", *("broken",) * 2, "hostile", *("missing",) * 4,
)  # fmt: skip
BROKEN = {
    "empty": b"",
    "half": b'{"cells": [{"cell_type": "code", "sou',
    "a page": b"<!DOCTYPE html><title>Log in</title>",
    "deep": b"[" * 100_000,
    "no cells": b'{"nbformat": 4}',
    "bytes": bytes(range(256)) * 40,
    "numbers": b'{"nbformat": 4, "metadata": {}, "cells": [1, 2, 3]}',
}
HOSTILE = {  # a cell before a right answer, and whether it meets a limit
    "endless": ("while True:\n    pass", True),
    "exit": ("import os\nos._exit(0)", False),
    "memory": ("hoard = bytearray(10**11)", True),
    "forks": ("import os\nwhile True:\n    os.fork()", True),
    "network": ("import socket\nsocket.create_connection(('1.1.1.1', 80), timeout=2)", False),
    "kill": ("import os\nos.kill(-1, 9)", False),
    "answers": ("from pathlib import Path\nprint(Path('SOLUTIONS').read_text())", False),
    "output": ("while True:\n    print('x' * 10_000)", True),
}


@dataclass(frozen=True)
class HandIn:
    """One file.

    Args:
        student: The sender.
        kind: Of KINDS.
        name: Of the change, for people.
        data: Of the file.
        expected: What each task must get.
        status: What the gradebook must say.
    """

    student: str
    kind: str
    name: str
    data: bytes
    expected: Mapping[str, str]
    status: tuple[str, ...]


@cache
def tasks_of(week: str) -> tuple[Task, ...]:
    return tuple(catalog().tasks_of_week(week))


def all_get(week: str, points: str) -> dict[str, str]:
    """Return the same result for all tasks, except manually marked ones."""
    return {task.id: ANY if task.rubric else points for task in tasks_of(week)}


@cache
def changes(week: str, kind: str) -> list[tuple[str, str, tuple[str, ...]]]:
    """Return name, task and cells of every way, miss or mutant of a week's solution."""
    cells = cells_of(solution(week))
    return [(name, task, tuple(new)) for name, task, new in _changes(week, kind, cells)]


def _changes(week: str, kind: str, cells: Sequence[str]) -> Iterator[tuple[str, str, list[str]]]:
    answers, names = read_answers(solutions_dir(), week), {task.id: task.name for task in tasks_of(week)}
    if kind == "mutant":
        for task, name in names.items():
            same = answers.same.get(task, ())
            among = [one for one in operators(solutions_dir()) if one.name not in same]
            for place, cell in enumerate(cells):
                if re.search(rf"^(class|def) {name}\b", cell, re.MULTILINE):
                    for operator, new in mutants(cell, among):
                        yield operator.name, task, [*cells[:place], new, *cells[place + 1 :]]
        return
    for one in answers.variants:
        if bool(one.way) == (kind == "way"):
            put = apply_changes(one, names[one.task], cells)
            yield one.miss or one.way, one.task, [put.get(place, cell) for place, cell in enumerate(cells)]


def expected_of(week: str, task: str, new: Sequence[str], points: str) -> dict[str, str]:
    """Return the expected results after a change of one task; tasks that depend on it may get any result."""
    cells = cells_of(solution(week))
    touched = {
        name
        for old, now in zip(cells, new, strict=True)
        if old != now
        for name in DEFINED.findall(f"{old}\n{now}")
    }
    made = all_get(week, FULL)
    for other in tasks_of(week):
        own = [cell for cell in cells if re.search(rf"^(class |def )?{other.name}\b", cell, re.MULTILINE)]
        if made[other.id] == FULL and any(re.search(rf"\b{name}\b", c) for name in touched for c in own):
            made[other.id] = ANY if points == LESS else FULL
    return {**made, task: points}


def file_of(week: str, student: str, cells: Sequence[str]) -> bytes:
    """Return an exercise with these cells and one that differs from all others, stamped with an ID."""
    made = read_notebook(solution(week))
    cell = next(one for one in made["cells"] if one["cell_type"] == "code")
    texts = [*cells, f"# This is the work of {student}."]
    new = {**made, "cells": [{**cell, "source": text} for text in texts]}
    return stamped(json.dumps(new).encode(), student)


def stamped(data: bytes, student: str) -> bytes:
    """Return a notebook with another student's ID."""
    made = json.loads(data)
    made["metadata"]["course"]["student"] = student
    return json.dumps(made).encode()


def handed_in(week: str, students: Sequence[str]) -> Iterator[HandIn]:
    """Yield the reproducible submissions of the students; some submit nothing."""
    before: HandIn | None = None
    for student in students:
        chance = random.Random(f"{week} {student}")
        kind = chance.choice(KINDS)
        if kind in ("twin", "copied"):
            if before is not None:
                yield _copy(student, kind, before)
        elif kind == "broken":
            name = chance.choice(list(BROKEN))
            yield HandIn(student, kind, name, BROKEN[name], {}, (REJECTED,))
        elif kind != "missing":
            name, cells, expected, status = _answer(week, kind, chance)
            one = HandIn(student, kind, name, file_of(week, student, cells), expected, status)
            yield one
            before = one if kind in ("right", "miss") else before


def _answer(
    week: str, kind: str, chance: random.Random
) -> tuple[str, Sequence[str], dict[str, str], tuple[str, ...]]:
    """Return the name, the cells, the points and the states of a notebook that can be run."""
    cells = cells_of(solution(week))
    if kind in ("way", "miss", "mutant") and not changes(week, kind):
        kind = "right"  # the week declares no such answers
    waits = (WAITS,) if any(task.rubric for task in tasks_of(week)) else (GRADED,)
    if kind == "right":
        return "", cells, all_get(week, FULL), waits
    if kind == "stub":
        exercise = read_notebook(exercise_path(solution(week)))["cells"]
        empty = [source(cell) for cell in exercise if cell["cell_type"] == "code"]
        return "", empty, all_get(week, NOTHING), waits
    if kind == "try":
        name = chance.choice(("first_try", "second_try"))
        answers = read_answers(solutions_dir(), week)
        wrong = dict.fromkeys(answers.files[name], LESS)
        return name, cells_of(answers.file(name)), all_get(week, ANY) | wrong, (*waits, LIMIT)
    if kind == "hostile":
        name = chance.choice(list(HOSTILE))
        text, limited = HOSTILE[name]
        text = text.replace("SOLUTIONS", str(solutions_dir() / "checks" / f"{week}.py"))
        return name, [text, *cells], all_get(week, FULL), (*waits, *((LIMIT,) if limited else ()))
    name, task, new = chance.choice(changes(week, kind))
    points = FULL if kind == "way" else LESS
    return name, new, expected_of(week, task, new, points), (*waits, LIMIT)


def _copy(student: str, kind: str, other: HandIn) -> HandIn:
    """Return somebody's work again: with the student's own ID, or with the other's, which is a mismatch."""
    data = stamped(other.data, student) if kind == "twin" else other.data
    status = other.status if kind == "twin" else (WAITS,)
    return HandIn(student, kind, f"{other.student}: {other.name}", data, other.expected, status)
