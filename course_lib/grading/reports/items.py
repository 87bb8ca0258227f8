"""Item analysis: how hard each task and check was, and whether it tells good work from poor work."""

import json
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from statistics import fmean, median
from typing import Any

import numpy as np

from course_lib.course.state import write_whole
from course_lib.foreign import read_json
from course_lib.grading.judge import CHECK_SECONDS, Judgement, TaskResult
from course_lib.grading.marks.marks import HandMark, marked_tasks, read_marks
from course_lib.grading.records import check_times_path, marks_path
from course_lib.grading.reports.table import csv_of, fill
from course_lib.grading.run.run import read_usage

SLOW = CHECK_SECONDS / 5  # [s] of a check, from which on it may fail on a slower machine
Name = tuple[str, ...]  # task and scenario, and of a check its title


@dataclass(frozen=True)
class Spent:
    """The processor time of one scenario or check: how often it was measured, median and maximum [s]."""

    count: int
    middle: float
    most: float

    @property
    def remark(self) -> str:
        """A reason to look at a check, or ""."""
        return f"slow: a check may take {CHECK_SECONDS:g} s" if self.most >= SLOW else ""


def keep_check_times(out: Path, key: str, judgement: Judgement) -> None:
    """Write the times of all checks beside the evidence: results are the same each time."""
    rows = [
        (task.task, check.scenario, check.title, round(check.seconds, 6))
        for task in judgement.tasks
        for check in task.checks
    ]
    write_whole(check_times_path(out, key), json.dumps(rows).encode())


def check_times(out: Path, keys: Iterable[str]) -> dict[Name, Spent]:
    """Return what each check took, by task, scenario and title."""
    return _spent(row for key in keys for row in _check_rows(out, key))


def scenario_times(out: Path, keys: Iterable[str]) -> dict[Name, Spent]:
    """Return what each scenario took in the jail, by task and name."""
    usages = (usage for key in keys if (usage := read_usage(out, key)))
    return _spent((name.partition("/")[::2], s) for usage in usages for name, s in usage.scenarios.items())


def _check_rows(out: Path, key: str) -> Iterator[tuple[Name, float]]:
    with suppress(OSError, ValueError, TypeError):  # missing or damaged: times are not worth an error
        for task, scenario, title, seconds in read_json(check_times_path(out, key).read_bytes()):
            yield (task, scenario, title), float(seconds)


def _spent(rows: Iterable[tuple[Name, float]]) -> dict[Name, Spent]:
    found = defaultdict[Name, list[float]](list)
    for name, seconds in rows:
        found[name].append(seconds)
    return {name: Spent(len(all_), median(all_), max(all_)) for name, all_ in found.items()}


TASK_COLUMNS = (
    "student", "exercise", "task", "score", "points", "bonus", "marked_by", "public_passed", "public",
    "hidden_passed", "hidden",
)  # fmt: skip
FEWEST = 10  # submissions, from which on a correlation says something
BINS = 10  # of a histogram, from 0 to 100 percent; what is above has one more
EASY, HARD, WEAK = 0.98, 0.1, 0.1  # shares, and a correlation


@dataclass(frozen=True)
class Item:
    """One task or check, over all submissions that were judged.

    Args:
        task: Its id.
        title: Of the check; "" for the whole task.
        scenario: Of the check; "" for the whole task.
        hidden: Whether students have the check.
        count: Submissions.
        rate: Share of them with the full score.
        mean: Mean score, from 0 to 1.
        discrimination: The correlation with the points of all others of the exercise; None for few or equal
            scores.
    """

    task: str
    title: str
    scenario: str
    hidden: bool
    count: int
    rate: float
    mean: float
    discrimination: float | None

    @property
    def remark(self) -> str:
        """A reason to look at it, or ""."""
        if self.count < FEWEST:
            return ""
        if self.mean >= EASY:
            return "nearly all have it"
        if self.mean <= HARD:
            return "hardly anybody has it: is it stated and taught?"
        if self.discrimination is not None and self.discrimination < 0:
            return "poor work has it more often than good work: is it right?"
        return "" if self.discrimination is None or self.discrimination > WEAK else "says little of the rest"


@dataclass(frozen=True)
class Analysis:
    """All of one exercise.

    Args:
        exercise: "week01_exercise".
        marks: In percent, after the late policy.
        tasks: In the order of the exercise.
        checks: Of each task, in its order.
        cpu_seconds: What running each submission took [s].
        scenario_times: Of the jail's processes, by task and scenario.
        check_times: Of judging, by task, scenario and title.
    """

    exercise: str
    marks: Sequence[float]
    tasks: Sequence[Item]
    checks: Sequence[Item]
    cpu_seconds: Sequence[float]
    scenario_times: Mapping[Name, Spent] = field(default_factory=dict)
    check_times: Mapping[Name, Spent] = field(default_factory=dict)

    @property
    def histogram(self) -> list[tuple[str, int, int]]:
        """The range, the number and the share of the largest number, in percent, of each bin."""
        width = 100 / BINS
        counts = [0] * (BINS + 1)
        for mark in self.marks:
            counts[min(int(mark // width), BINS) if mark != 100 else BINS - 1] += 1
        names = [f"{place * width:g}-{(place + 1) * width:g}" for place in range(BINS)]
        most = max(*counts, 1)
        return [
            (name, n, round(100 * n / most)) for name, n in zip([*names, "above 100"], counts, strict=True)
        ]

    @property
    def summary(self) -> str:
        """One line on marks and times."""
        if not self.marks:
            return "No marks."
        spread = (
            f"{len(self.marks)} marks: mean {fmean(self.marks):.1f}, median {median(self.marks):.1f} percent"
        )
        if not self.cpu_seconds:
            return f"{spread}."
        times = f"median {median(self.cpu_seconds):.2f} s, at most {max(self.cpu_seconds):.2f} s"
        return f"{spread}. Processor time of a submission: {times}."


def write_items(out: Path, results: Iterable[Mapping[str, Any]]) -> None:
    """Write OUT/tasks.csv, a line for each student and task, and OUT/reports/items.html."""
    rows, found = list[tuple[Any, ...]](), defaultdict[str, list[Mapping[str, Any]]](list)
    for result in results:
        marks = read_marks(marks_path(out, result["student"], result["exercise"]))
        rows += _task_rows(result, marks)
        found[result["exercise"]].append(result)
    write_whole(out / "tasks.csv", csv_of(TASK_COLUMNS, rows))
    page = fill("items.html", exercises=[analyse(name, found[name], out) for name in sorted(found)])
    write_whole(out / "reports" / "items.html", page.encode("utf-8", "replace"))


def _task_rows(result: Mapping[str, Any], marks: Sequence[HandMark]) -> Iterator[tuple[Any, ...]]:
    for task in marked_tasks(result, marks):
        sides = [[check for check in task.checks if check.hidden is hidden] for hidden in (False, True)]
        numbers = [n for side in sides for n in (sum(check.passed for check in side), len(side))]
        by = "" if task.waits else "checks" if task.manual is None else "person"
        names = (result["student"], result["exercise"], task.task)
        yield (*names, task.score, task.points, int(task.bonus), by, *numbers)


def analyse(exercise: str, results: Sequence[Mapping[str, Any]], out: Path) -> Analysis:
    """Return the analysis of one exercise from its results."""
    judged = [[TaskResult.from_plain(task) for task in one["tasks"]] for one in results if one.get("tasks")]
    rows = [one["row"] for one in results if one["row"]["max_score"]]
    keys = [one["attempts"][-1]["key"] for one in results if one.get("tasks")]
    usages = [read_usage(out, key) for key in keys]
    return Analysis(
        exercise,
        [100 * float(row["final"]) / float(row["max_score"]) for row in rows],
        list(_items(judged, of_checks=False)),
        list(_items(judged, of_checks=True)),
        [usage.cpu_seconds for usage in usages if usage],
        scenario_times(out, keys),
        check_times(out, keys),
    )


Key = tuple[str, str, str, bool]  # task, title, scenario, hidden


def _items(judged: Iterable[Sequence[TaskResult]], *, of_checks: bool) -> Iterator[Item]:
    scores, rests = defaultdict[Key, list[float]](list), defaultdict[Key, list[float]](list)
    for tasks in judged:
        whole = sum(task.points * task.fraction for task in tasks)
        for key, score, points in (part for task in tasks for part in _parts(task, of_checks)):
            scores[key].append(score)
            rests[key].append(whole - points)
    for key, got in scores.items():
        rate = sum(score >= 1 for score in got) / len(got)
        yield Item(*key, len(got), rate, fmean(got), correlation(got, rests[key]))


def _parts(task: TaskResult, of_checks: bool) -> Iterator[tuple[Key, float, float]]:
    """Yield the name, the score and the points of a task, or of each check of it."""
    weights = sum(check.weight for check in task.checks)
    if not weights:
        return
    if not of_checks:
        yield (task.task, "", "", False), task.fraction, task.points * task.fraction
        return
    for check in task.checks:
        points = task.points * check.weight * check.score / weights
        yield (task.task, check.title, check.scenario, check.hidden), check.score, points


def correlation(scores: Sequence[float], rests: Sequence[float]) -> float | None:
    """Return Pearson's correlation; None for few submissions, or where one side is always the same."""
    if len(scores) < FEWEST or np.ptp(scores) < 1e-9 or np.ptp(rests) < 1e-9:
        return None
    return float(np.corrcoef(scores, rests)[0, 1])
