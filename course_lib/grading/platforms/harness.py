"""Grading one submission where Gradescope has put it, into results/results.json."""

import json
import shutil
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from course_lib.course.identity import normalise
from course_lib.course.state import write_whole
from course_lib.errors import CourseError, counted
from course_lib.foreign import read_json
from course_lib.grading.grade import grade
from course_lib.grading.handin.collect import PlatformTime, collect, write_receipts
from course_lib.grading.handin.submission import find_submissions
from course_lib.grading.jail.isolation import Need
from course_lib.grading.judge import CheckResult, TaskResult
from course_lib.grading.marks.mark import Result, read_result
from course_lib.grading.records import Course, catalog_of, result_path, this_course
from course_lib.grading.reports.table import printable, rows, say
from course_lib.grading.term.class_list import read_class_list

ROSTER = "roster.csv"  # in solutions/, which no submission may read
METADATA = "submission_metadata.json"
UNKNOWN = "gradescope"  # the student, where nothing names one
MAX_METADATA = 10_000_000  # [B]; it holds the results of all earlier submissions
MOST_NAMED = 10  # files in a line
MAX_TEXT = 20_000  # characters of one text of the results


@dataclass(frozen=True)
class Upload:
    """The sender and the time of an upload, by Gradescope's metadata.

    Args:
        student: The ID by the roster, else Gradescope's number.
        named: Whether the roster names the student.
        time: Of the upload, as Gradescope writes it, or "".
    """

    student: str
    named: bool
    time: str


def grade_upload(week: str, root: Path, *, hidden: str, need: Need, course: Course | None = None) -> Path:
    """Grade ROOT/submission and write ROOT/results/results.json.

    Args:
        week: "week01".
        root: Gradescope's /autograder.
        hidden: When students see the results of hidden checks, in Gradescope's word.
        need: The least isolation.
        course: Default: the one that is installed.

    Raises:
        CourseError: A fault that is not the student's; then there is no results.json, so that Gradescope
            shows an error of the autograder and no mark.
    """
    begin, course = time.monotonic(), course or this_course()
    target = root / "results" / "results.json"
    target.parent.mkdir(exist_ok=True)
    target.unlink(missing_ok=True)
    upload, exercise = _upload(root / METADATA, course), f"{week}_exercise"
    with tempfile.TemporaryDirectory(prefix="course_") as work:
        top, out = Path(work, "in"), Path(work, "out")
        if exercise in _collected(root / "submission", upload, Path(work), course):
            only = f"{upload.student}/{exercise}"
            grade(top, out, jobs=1, only=only, need=need, course=course)
            content = read_result(result_path(out, upload.student, exercise))
            made = results_of(content, hidden)
        else:
            made = _missing(exercise, root / "submission")
    made["execution_time"] = round(time.monotonic() - begin, 1)
    write_whole(target, json.dumps(made, indent=1).encode())
    return target


def _upload(path: Path, course: Course) -> Upload:
    """Read the metadata of a submission; without the file nobody and no time is known."""
    if not path.is_file():
        return Upload(UNKNOWN, False, "")
    try:
        with path.open("rb") as file:
            content = read_json(file.read(MAX_METADATA))
        users = [user for user in content["users"] if isinstance(user, dict)]
        created, number = str(content["created_at"]), str(users[0]["id"])
        emails = [str(user.get("email") or "").casefold() for user in users]
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise CourseError(f"{path} can't be read: {error!r}. Gradescope writes it") from error
    roster = course.solutions / ROSTER
    known = read_class_list(roster).members if roster.is_file() else ()
    named = next((one.id for email in emails for one in known if email and one.email == email), "")
    return Upload(named or normalise(f"{UNKNOWN}{number}"), bool(named), created)


def _collected(submission: Path, upload: Upload, work: Path, course: Course) -> set[str]:
    """Sort a submission's files into WORK/in, with their time; returns the exercises among them."""
    if not submission.is_dir():
        raise CourseError(f"{submission} is missing: Gradescope puts the student's files there")
    top, zone = work / "in", catalog_of(course).course.zone
    try:
        shutil.copytree(submission, work / "class" / upload.student, symlinks=True)
    except shutil.Error as error:  # after all others are copied
        for name, _, why in error.args[0]:
            say(f"refused: {name}: {why}")
    try:
        done = collect(work / "class", top, zone)
    except CourseError:  # nothing is in it
        return set()
    for line in done.refused:
        say(line)
    if not done.count:
        return set()
    write_receipts(top, {upload.student: PlatformTime(upload.time, METADATA, upload.named)})
    return {one.exercise for one in find_submissions(top, zone=zone)}


def _missing(exercise: str, submission: Path) -> dict[str, Any]:
    """Return the results of a submission without the exercise: no points, and what was expected."""
    there = sorted(path.name for path in submission.iterdir())
    names = ", ".join(map(printable, there[:MOST_NAMED])) or "nothing"
    text = f"{exercise}.ipynb is missing, or the zip that `course submit` writes. You handed in: {names}."
    return {"score": 0.0, "output": text[:MAX_TEXT], "output_format": "text", "tests": []}


def results_of(content: Mapping[str, Any], hidden: str) -> dict[str, Any]:
    """Return what Gradescope shows of a result.

    Args:
        content: Of the result's file.
        hidden: When students see the results of hidden checks.

    Raises:
        CourseError: The kit failed: no student gets zero for that.
    """
    result, row = Result.from_plain(content), content["row"]
    if result.status == "grader_error":
        raise CourseError(
            f"the grader failed, which is not the student's fault: {result.reason} {result.message}"
        )
    judged, mark = result.judgement, result.mark
    tests = [test for task in judged.tasks for test in _tests(task, hidden)] if judged else []
    lines = [row["reason"], row["message"]]
    if mark and mark.days_late:
        lines += [f"{counted(mark.days_late, 'started day')} late: {mark.score:g} - {mark.penalty:g} points"]
    if judged:
        lines += [*judged.cell_errors, f"Ran with isolation: {judged.isolation}."]
    return {
        "score": mark.final if mark else 0.0,
        "output": _text(lines),
        "output_format": "text",
        "stdout_visibility": "hidden",
        "tests": [{"number": str(number), **test} for number, test in enumerate(tests, 1)],
        "extra_data": {"status": row["status"], "isolation": judged.isolation if judged else ""},
    }


def _tests(task: TaskResult, hidden: str) -> Iterator[dict[str, Any]]:
    """Yield a task's public checks as one test and its hidden checks as another, which share its points."""
    whole = sum(check.weight for check in task.checks)
    if not whole:
        yield {"name": f"{task.title}: a person marks it", "output": "", "visibility": "visible"}
        return
    bonus = " (bonus)" if task.bonus else ""
    left, most_left = task.score, task.points
    public = [check for check in task.checks if not check.hidden]
    parts = (("", public, "visible"), (", hidden checks", [c for c in task.checks if c.hidden], hidden))
    for words, checks, visibility in (part for part in parts if part[1]):
        is_last = len(checks) == len(task.checks) or checks is not public
        share = sum(check.weight * check.score for check in checks) / whole
        score = left if is_last else round(task.points * share, 2)
        most = most_left if is_last else round(task.points * sum(c.weight for c in checks) / whole, 2)
        left, most_left = round(left - score, 2), round(most_left - most, 2)
        yield {
            "name": f"{task.title}{words}{bonus}",
            "score": max(score, 0.0),
            "max_score": most,
            "status": "passed" if all(check.passed for check in checks) else "failed",
            "output": _text([*(task.errors if checks is public else ()), *_lines(checks)]),
            "output_format": "text",
            "visibility": visibility,
        }


def _lines(checks: Sequence[CheckResult]) -> list[str]:
    return [": ".join(filter(None, (f"{icon} {title}", why))) for icon, _, title, why in rows(checks)]


def _text(lines: Sequence[str]) -> str:
    shown = (printable(part) for line in lines if line for part in line.splitlines())
    return "\n".join(shown)[:MAX_TEXT]
