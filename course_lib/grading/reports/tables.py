"""Tables of all results: gradebook.csv, index with submissions to review, and item analysis.

The item analysis shows the difficulty of each task and check, and whether it discriminates between
students.
"""

import json
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from statistics import fmean, median
from typing import Any
from urllib.parse import quote
from zoneinfo import ZoneInfo

import numpy as np

from course_lib.errors import format_count
from course_lib.files import write_atomically
from course_lib.grading.judge import CHECK_SECONDS
from course_lib.grading.marks import COLUMNS, MarkedResult, results_in
from course_lib.grading.records import MISMATCH, NO_ID, UNVERIFIED, Judgement, TaskResult
from course_lib.grading.reports.rendering import csv_of, fill, join_few
from course_lib.grading.run.run import read_usage
from course_lib.grading.store import check_times_path
from course_lib.grading.submissions.copies import SimilarSubmission, read_similar
from course_lib.third_party import read_json

SLOW = CHECK_SECONDS / 5  # [s] duration of a check that may reach its time limit on a slower machine
Name = tuple[str, ...]  # (task, scenario), and the title of a check


@dataclass(frozen=True)
class TimeSummary:
    """The CPU time of one scenario or check: number of measurements, median and maximum [s]."""

    count: int
    median_seconds: float
    longest_seconds: float

    @property
    def remark(self) -> str:
        """A warning about a slow check, or ""."""
        return f"slow: a check may take {CHECK_SECONDS:g} s" if self.longest_seconds >= SLOW else ""


def write_check_times(out: Path, key: str, judgement: Judgement) -> None:
    """Write the times of all checks next to the evidence.

    Results must be reproducible, so they lack times.
    """
    rows = [
        (task.task, check.scenario, check.title, round(check.seconds, 6))
        for task in judgement.tasks
        for check in task.checks
    ]
    write_atomically(check_times_path(out, key), json.dumps(rows).encode())


def check_times(out: Path, keys: Iterable[str]) -> dict[Name, TimeSummary]:
    """Return the times of each check, by task, scenario and title."""
    rows: list[tuple[Name, float]] = []
    for key in keys:
        # Missing or damaged times do not matter enough for an error.
        with suppress(OSError, ValueError, TypeError):
            for task, scenario, title, seconds in read_json(check_times_path(out, key).read_bytes()):
                rows.append(((task, scenario, title), float(seconds)))
    return _summarize_times(rows)


def scenario_times(out: Path, keys: Iterable[str]) -> dict[Name, TimeSummary]:
    """Return the times of each scenario in the jail, by task and name."""
    usages = (usage for key in keys if (usage := read_usage(out, key)))
    return _summarize_times(
        (name.partition("/")[::2], s) for usage in usages for name, s in usage.scenarios.items()
    )


def _summarize_times(rows: Iterable[tuple[Name, float]]) -> dict[Name, TimeSummary]:
    seconds_by_name = defaultdict[Name, list[float]](list)
    for name, seconds in rows:
        seconds_by_name[name].append(seconds)
    return {name: TimeSummary(len(all_), median(all_), max(all_)) for name, all_ in seconds_by_name.items()}


TASK_COLUMNS = (
    "student", "exercise", "task", "score", "points", "bonus", "marked_by", "public_passed", "public",
    "hidden_passed", "hidden",
)  # fmt: skip
FEWEST = 10  # minimum number of submissions for a meaningful correlation
BINS = 10  # bins of the histogram from 0 to 100 percent; higher marks have an additional bin
EASY, HARD, WEAK = 0.98, 0.1, 0.1  # limits on the mean score (two) and on the correlation


@dataclass(frozen=True)
class Item:
    """One task or check, over all judged submissions.

    Args:
        task: The task's id.
        title: The check's title; "" for the whole task.
        scenario: The check's scenario; "" for the whole task.
        is_hidden: Whether the check is hidden from students.
        count: Number of submissions.
        rate: Fraction of submissions with the full score.
        mean: Mean score, from 0 to 1.
        discrimination: The correlation with the points of all other items of the exercise; None for
            few or equal scores.
    """

    task: str
    title: str
    scenario: str
    is_hidden: bool
    count: int
    rate: float
    mean: float
    discrimination: float | None

    @property
    def remark(self) -> str:
        """A reason to review the item, or ""."""
        if self.count < FEWEST:
            return ""
        if self.mean >= EASY:
            return "almost all students have it"
        if self.mean <= HARD:
            return "hardly any student has it: is it stated and taught?"
        if self.discrimination is not None and self.discrimination < 0:
            return "poor work has it more often than good work: is it right?"
        return (
            ""
            if self.discrimination is None or self.discrimination > WEAK
            else "hardly correlates with the rest"
        )


@dataclass(frozen=True)
class Analysis:
    """The item analysis of one exercise.

    Args:
        exercise: "week01_exercise".
        marks: Marks in percent, after the late policy.
        tasks: The tasks in the order of the exercise.
        checks: The checks of each task, in order.
        cpu_seconds: CPU time of each submission [s].
        scenario_times: Times in the jail, by task and scenario.
        check_times: Times of judging, by task, scenario and title.
    """

    exercise: str
    marks: Sequence[float]
    tasks: Sequence[Item]
    checks: Sequence[Item]
    cpu_seconds: Sequence[float]
    scenario_times: Mapping[Name, TimeSummary] = field(default_factory=dict)
    check_times: Mapping[Name, TimeSummary] = field(default_factory=dict)

    @property
    def histogram(self) -> list[tuple[str, int, int]]:
        """The range, the count, and the percentage of the largest count, for each bin."""
        width = 100 / BINS
        counts = [0] * (BINS + 1)
        for mark in self.marks:
            counts[min(int(mark // width), BINS) if mark != 100 else BINS - 1] += 1
        names = [f"{place * width:g}-{(place + 1) * width:g}" for place in range(BINS)]
        max_count = max(*counts, 1)
        return [
            (name, n, round(100 * n / max_count))
            for name, n in zip([*names, "above 100"], counts, strict=True)
        ]

    @property
    def summary(self) -> str:
        """One line with the mean and median mark, and the processor times."""
        if not self.marks:
            return "No marks."
        spread = (
            f"{len(self.marks)} marks: mean {fmean(self.marks):.1f}, median {median(self.marks):.1f} percent"
        )
        if not self.cpu_seconds:
            return f"{spread}."
        times = f"median {median(self.cpu_seconds):.2f} s, at most {max(self.cpu_seconds):.2f} s"
        return f"{spread}. Processor time of a submission: {times}."


def analyse(exercise: str, results: Sequence[MarkedResult], out: Path) -> Analysis:
    """Return the item analysis of one exercise."""
    task_results = [result.result.tasks for result in results if result.result.tasks]
    marks = [result.row.mark for result in results if result.row.mark]
    keys = [result.result.attempts[-1].key for result in results if result.result.tasks]
    usages = [read_usage(out, key) for key in keys]
    return Analysis(
        exercise,
        [100 * mark.final / mark.max_score for mark in marks if mark.max_score],
        list(_items(task_results, of_checks=False)),
        list(_items(task_results, of_checks=True)),
        [usage.cpu_seconds for usage in usages if usage],
        scenario_times(out, keys),
        check_times(out, keys),
    )


Key = tuple[str, str, str, bool]  # (task, title, scenario, is_hidden)


def _items(task_results: Iterable[Sequence[TaskResult]], *, of_checks: bool) -> Iterator[Item]:
    """Yield the statistics of each automatically marked task, or of each of its checks."""
    scores, rests = defaultdict[Key, list[float]](list), defaultdict[Key, list[float]](list)
    for tasks in task_results:
        total = sum(task.points * task.fraction for task in tasks)
        for task in tasks:
            weights = sum(check.weight for check in task.checks)
            if weights and not of_checks:
                key: Key = (task.task, "", "", False)
                scores[key].append(task.fraction)
                rests[key].append(total - task.points * task.fraction)
            for check in task.checks if weights and of_checks else ():
                key = (task.task, check.title, check.scenario, check.is_hidden)
                scores[key].append(check.score)
                rests[key].append(total - task.points * check.weight * check.score / weights)
    for key, task_scores in scores.items():
        rate = sum(score >= 1 for score in task_scores) / len(task_scores)
        yield Item(*key, len(task_scores), rate, fmean(task_scores), correlation(task_scores, rests[key]))


def correlation(scores: Sequence[float], rests: Sequence[float]) -> float | None:
    """Return Pearson's correlation, or None for few submissions or a constant side."""
    if len(scores) < FEWEST or np.ptp(scores) < 1e-9 or np.ptp(rests) < 1e-9:
        return None
    return float(np.corrcoef(scores, rests)[0, 1])


def write_gradebook(out: Path, results: Iterable[MarkedResult]) -> Path:
    """Write OUT/gradebook.csv from the gradebook rows of all results."""
    path = out / "gradebook.csv"
    write_atomically(path, csv_of(COLUMNS, (result.row.cells.values() for result in results)))
    return path


SAME_ID, SIMILAR, NOT_COMPARED = "same ID", "similar code", "code not compared"
ADVICE = {
    MISMATCH: "marked, but not exported until you have reviewed them. Wrong folder: move the file and grade "
    "again. Otherwise accept it by a mark: course mark OUT STUDENT EXERCISE TASK POINTS. "
    "Folders that are not named after IDs: course collect with --roster",
    NO_ID: "the files have no ID; judged for the student who submitted, or for a guest without a roster",
    UNVERIFIED: "only the files identify their students; collect with --roster to verify the IDs",
    SAME_ID: "several folders or files have the ID of one student; one counts. Upper and lower case do "
    "not distinguish IDs. If one of them belongs to another student, rename it and grade again",
    SIMILAR: "compare side by side in",
    NOT_COMPARED: "too long, or built at run time; read it. The reasons are in",
}


@dataclass(frozen=True)
class Flag:
    """A reason to review a submission, and a link with details, or ""."""

    kind: str
    text: str
    link: str = ""


@dataclass(frozen=True)
class Concern:
    """A reason to review several submissions, with pages in OUT/reports that have details."""

    text: str
    pages: tuple[str, ...] = ()

    def line(self, out: Path) -> str:
        """Return the line for the terminal."""
        return " ".join([self.text, ", ".join(str(out / "reports" / page) for page in self.pages)]).rstrip()


def flags(result: MarkedResult, similar_code: Mapping[tuple[str, str], SimilarSubmission]) -> list[Flag]:
    """Return the reasons to review one result."""
    submission = result.result.submission
    raised = [Flag(submission.id_flag, submission.id_flag)] if submission.id_flag else []
    # Files outside of a student's folder are all attempts of the student whose ID they contain.
    if any(not name.lower().endswith((".ipynb", ".zip")) for name in submission.rivals):
        raised.append(Flag(SAME_ID, f"{SAME_ID}: {join_few(submission.rivals)}"))
    if similar := similar_code.get((result.student, result.exercise)):
        if similar.others:
            raised.append(Flag(SIMILAR, f"{SIMILAR}: {join_few(similar.others)}", similar.link))
        if similar.remarks:
            raised.append(Flag(NOT_COMPARED, f"{NOT_COMPARED}: {'; '.join(similar.remarks)}", similar.link))
    return raised


def review_reasons(results: Iterable[MarkedResult], out: Path) -> list[Concern]:
    """Return each reason to review submissions, with the submissions."""
    similar_code = read_similar(out)
    students_by_kind, pages = defaultdict[str, list[str]](list), defaultdict[str, set[str]](set)
    for result in results:
        is_held = result.row.status == "needs_marking"
        for flag in (flag for flag in flags(result, similar_code) if flag.kind != MISMATCH or is_held):
            students_by_kind[flag.kind].append(f"{result.student} {result.exercise}")
            pages[flag.kind] |= {flag.link.split("#")[0]} - {""}
    return [
        Concern(
            f"{kind}: {format_count(len(students_by_kind[kind]), 'submission')} "
            f"({join_few(students_by_kind[kind])}): {advice}",
            tuple(sorted(pages[kind])),
        )
        for kind, advice in ADVICE.items()
        if kind in students_by_kind
    ]


# Key in the result's row and heading. Numeric columns are sorted numerically.
INDEX_COLUMNS = (
    ("student", "student"), ("exercise", "exercise"), ("final", "mark"), ("max_score", "of"),
    ("score", "before late policy"), ("days_late", "days late"), ("status", "status"), ("reason", "reason"),
    ("message", "message"), ("cpu_seconds", "CPU [s]"), ("memory_megabytes", "memory [MB]"),
)  # fmt: skip


def write_tables(out: Path, zone: ZoneInfo) -> list[MarkedResult]:
    """Write the gradebook, the index and the item analysis, and return all results."""
    results = list(results_in(out))
    rows, results_by_exercise = list[tuple[Any, ...]](), defaultdict[str, list[MarkedResult]](list)
    for result in results:
        for task in result.tasks:
            public = [check.passed for check in task.checks if not check.is_hidden]
            hidden = [check.passed for check in task.checks if check.is_hidden]
            counts = (sum(public), len(public), sum(hidden), len(hidden))
            by = "" if task.needs_hand_mark else "checks" if task.manual is None else "person"
            names = (result.student, result.exercise, task.task)
            rows.append((*names, task.score, task.points, int(task.is_bonus), by, *counts))
        results_by_exercise[result.exercise].append(result)
    write_atomically(out / "tasks.csv", csv_of(TASK_COLUMNS, rows))
    page = fill(
        "items.html",
        exercises=[analyse(name, results_by_exercise[name], out) for name in sorted(results_by_exercise)],
    )
    write_atomically(out / "reports" / "items.html", page.encode("utf-8", "replace"))
    write_gradebook(out, results)
    write_index(out, zone, results)
    return results


def write_index(out: Path, zone: ZoneInfo, results: Sequence[MarkedResult]) -> Path:
    """Write OUT/reports/index.html from all results, with times in a zone."""
    failures, similar_code = _failures(results), read_similar(out)
    page = fill(
        "index.html",
        headings=[heading for _, heading in INDEX_COLUMNS],
        lines=[{**_line(result, out, zone), "flags": flags(result, similar_code)} for result in results],
        concerns=review_reasons(results, out),
        counts=sorted(Counter(result.row.status for result in results).items()),
        isolations=Counter(result.result.isolation for result in results).most_common(),
        failures=[row for row in failures if row["failed"]],
        never=sum(not row["failed"] for row in failures),
        zone=zone.key,
    )
    path = out / "reports" / "index.html"
    write_atomically(path, page.encode("utf-8", "replace"))
    return path


def _line(result: MarkedResult, out: Path, zone: ZoneInfo) -> dict[str, Any]:
    usage = read_usage(out, result.result.attempts[-1].key)
    row = {**result.row.cells, **(asdict(usage) if usage else {})}
    cells = [row.get(key, "") for key, _ in INDEX_COLUMNS]
    place = f"{row['student']}/{row['exercise']}.html"
    time = result.result.submission.received.time
    return {
        "link": quote(place, errors="surrogateescape") if (out / "reports" / place).is_file() else "",
        "cells": [f"{v:g}" if isinstance(v, float) else v for v in cells],
        "received": time.astimezone(zone).isoformat(" ", "minutes") if time else "unknown",
        "notes": result.result.notes,
    }


def _failures(results: Iterable[MarkedResult]) -> list[dict[str, Any]]:
    """Return each check with the number of submissions that failed it, most failed first."""
    judged_counts, failed = Counter[tuple[Any, ...]](), Counter[tuple[Any, ...]]()
    for result in results:
        for task in result.result.tasks:
            for check in task.checks:
                key = task.task, check.title, check.scenario, check.is_hidden
                judged_counts[key] += 1
                failed[key] += not check.passed
    shares = sorted(judged_counts, key=lambda key: (-failed[key] / judged_counts[key], key))
    return [{"names": key, "failed": failed[key], "of": judged_counts[key]} for key in shares]
