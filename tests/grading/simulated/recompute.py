"""Compare the records of a graded class with the expected results, without using the kit."""

import csv
import json
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8-sig") as file:
        return list(csv.DictReader(file))


def points(task: Mapping[str, Any], marks: list[dict[str, Any]]) -> Fraction:
    mine = [mark for mark in marks if mark["task"] == task["task"]]
    if mine and not mine[-1]["row"]:
        return Fraction(str(mine[-1]["points"]))
    weights = sum(Fraction(str(check["weight"])) for check in task["checks"])
    if not weights:
        return Fraction(0)
    got = sum(Fraction(str(check["weight"])) * Fraction(str(check["score"])) for check in task["checks"])
    return Fraction(str(task["points"])) * got / weights


def disagreements(out: Path, declared: list[dict[str, Any]], percent_per_day: float) -> list[str]:
    """Return a line for each submission whose records differ from the expected results.

    A task that is declared "full" has all its points, "less" fewer, "nothing" none; "any" is not
    compared.
    """
    book = {(row["student"], row["exercise"]): row for row in table(out / "gradebook.csv")}
    made = []
    for one in declared:
        row = book.get((one["student"], one["exercise"]))
        told = _faults(out, one, row, percent_per_day) if row else ["not in the gradebook"]
        made += [f"{one['exercise']} {one['student']} ({one['kind']} {one['name']}): {text}" for text in told]
    handed = {(one["student"], one["exercise"]) for one in declared}
    return made + [f"nobody handed in {found}" for found in book.keys() - handed]


def _faults(out: Path, one: dict[str, Any], row: dict[str, str], percent_per_day: float) -> list[str]:
    marks = out / "marks" / one["student"] / f"{one['exercise']}.json"
    given = json.loads(marks.read_text()) if marks.is_file() else []
    read = {mark["task"] for mark in given}
    states = [*one["status"], *["graded"] * ("needs_marking" in one["status"] and bool(read))]
    made = [] if row["status"] in states else [f"{row['status']}, expected one of {states}"]
    result = json.loads((out / "results" / one["student"] / f"{one['exercise']}.json").read_text())
    tasks = (result["judgement"] or {}).get("tasks", ())
    got = {task["task"]: points(task, given) for task in tasks}
    most = {task["task"]: Fraction(str(task["points"])) for task in tasks}
    fits = {"full": lambda n, m: n == m, "less": lambda n, m: n < m, "nothing": lambda n, m: n == 0}
    for task, expected in one["tasks"].items():
        if task not in read and expected in fits and not fits[expected](got[task], most[task]):
            made.append(f"{task}: {float(got[task]):g} of {most[task]} points, expected {expected}")
    if got:
        if int(row["days_late"]) != one["days_late"]:
            made.append(f"{row['days_late']} days late, expected {one['days_late']}")
        share = max(0, 1 - one["days_late"] * Fraction(str(percent_per_day)) / 100)
        if abs(Fraction(row["final"]) - sum(got.values()) * share) > Fraction(3, 100):
            made.append(f"final {row['final']}, expected {float(sum(got.values()) * share):.2f}")
    return made
