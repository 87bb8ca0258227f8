"""The totals of a term, computed again from OUT/results and OUT/marks without the kit: Python alone.

python recompute.py OUT ROSTER COURSE_TOML [EXEMPTIONS [QUIZZES]] prints a line for each student.
"""

import csv
import json
import math
import sys
import tomllib
from collections.abc import Mapping
from datetime import UTC, datetime, timedelta
from fractions import Fraction
from pathlib import Path
from typing import Any
from zoneinfo import ZoneInfo


def table(path: Path | None) -> list[dict[str, str]]:
    if path is None:
        return []
    with path.open(newline="", encoding="utf-8-sig") as file:
        return list(csv.DictReader(file))


def days_late(received: str | None, deadline: datetime | None, zone: ZoneInfo, grace: float) -> int:
    if received is None or deadline is None:
        return 0
    days, due = 0, deadline.replace(tzinfo=zone)
    while datetime.fromisoformat(received) > due.astimezone(UTC) + timedelta(minutes=grace):
        days, due = days + 1, due + timedelta(days=1)  # the same local time of the next day
    return days


def points(task: Mapping[str, Any], marks: list[dict[str, Any]]) -> Fraction:
    mine = [mark for mark in marks if mark["task"] == task["task"]]
    if mine and not mine[-1]["row"]:
        return Fraction(str(mine[-1]["points"]))
    weights = sum(Fraction(str(check["weight"])) for check in task["checks"])
    if not weights:
        return Fraction(0)
    got = sum(Fraction(str(check["weight"])) * Fraction(str(check["score"])) for check in task["checks"])
    return Fraction(str(task["points"])) * got / weights


def percent(path: Path, marks: Path, settings: dict[str, Any]) -> tuple[str, str, Fraction | None]:
    """Return the status, the time and the percent of one result."""
    result = json.loads(path.read_text())
    if "tasks" not in result:
        return result["status"], result["received"] or "", None
    given = json.loads(marks.read_text()) if marks.is_file() else []
    week = settings["weeks"][path.stem.split("_")[0]]
    deadline = week.get("extensions", {}).get(path.parent.name, week.get("deadline"))
    late = settings["late"]
    zone = ZoneInfo(settings["time_zone"])
    days = days_late(result["received"], deadline, zone, late.get("grace_minutes", 0))
    score = sum(points(task, given) for task in result["tasks"])
    whole = sum(Fraction(str(task["points"])) for task in result["tasks"] if not task["bonus"])
    share = max(Fraction(0), 1 - days * Fraction(str(late["percent_per_day"])) / 100)
    return result["status"], result["received"] or "", 100 * score * share / whole


Found = dict[tuple[str, str], tuple[str, str, Fraction | None]]  # by week and student


def team_of(
    one: dict[str, str], students: list[dict[str, str]], week: str, term: dict[str, Any]
) -> list[str]:
    if week in term.get("group_weeks", []) and one["group"]:
        return [other["id"] for other in students if other["group"] == one["group"]]
    return [one["id"]]


def mark_of(team: list[str], week: str, found: Found) -> Fraction | None:
    """Return the last mark of a team, zero without a hand-in, None for a fault of the grader."""
    handed = [(*found[week, member], member) for member in team if (week, member) in found]
    if with_mark := [(time, mark, who) for _, time, mark, who in handed if mark is not None]:
        return max(with_mark)[1]
    return None if any(status == "grader_error" for status, *_ in handed) else Fraction(0)


def total(counted: dict[str, Fraction], quiz: dict[str, Fraction], term: dict[str, Any]) -> float | None:
    weight = {week: Fraction(str(term.get("weights", {}).get(week, 1))) for week in counted}
    worst = sorted(counted, key=lambda week: (counted[week], -weight[week], week))
    worst = worst[: min(int(term.get("drop_lowest", 0)), max(len(counted) - 1, 0))]
    kept = [week for week in counted if week not in worst]
    if not kept:
        return None
    mean = sum(counted[week] * weight[week] for week in kept) / sum(weight[week] for week in kept)
    share = Fraction(str(term.get("quiz_percent", 0))) / 100
    quizzed = sum(quiz.get(week, Fraction(0)) for week in counted) / len(counted)
    return float(mean * (1 - share) + share * quizzed)


def totals(
    out: Path, roster: Path, toml: Path, exemptions: Path | None = None, quizzes: Path | None = None
) -> dict[str, float | None]:
    settings = tomllib.loads(toml.read_text())
    term, students = settings["term"], table(roster)
    found = {
        (path.stem.split("_")[0], path.parent.name): percent(
            path, out / "marks" / path.parent.name / path.name, settings
        )
        for path in (out / "results").glob("*/*.json")
    }
    exempt = {(row["week"], row["id"]) for row in table(exemptions)}
    made: dict[str, float | None] = {}
    for one in students:
        counted: dict[str, Fraction] = {}
        for week in sorted({week for week, _ in found}):
            if (week, one["id"]) in exempt or term.get("weights", {}).get(week, 1) == 0:
                continue
            mark = mark_of(team_of(one, students, week, term), week, found)
            if mark is not None:
                counted[week] = mark
        quiz = {row["week"]: Fraction(row["percent"]) for row in table(quizzes) if row["id"] == one["id"]}
        made[one["id"]] = total(counted, quiz, term)
    return made


def disagreements(out: Path, declared: list[dict[str, Any]], percent_per_day: float) -> list[str]:
    """Return a line for each hand-in whose records are not what its answers were declared to get.

    A task that is declared "full" has all its points, "less" fewer, "nothing" none; "any" is not compared.
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
    got = {task["task"]: points(task, given) for task in result.get("tasks", ())}
    most = {task["task"]: Fraction(str(task["points"])) for task in result.get("tasks", ())}
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


if __name__ == "__main__":
    for student, result in totals(*map(Path, sys.argv[1:])).items():
        sys.stdout.write(f"{student} {math.nan if result is None else result:.2f}\n")
