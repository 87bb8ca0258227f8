"""`course term`: the marks of all weeks of a class, as one table with totals."""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean, median
from typing import Any

from course_lib.course.course_file import CourseFile, read_course_file
from course_lib.course.installation import exercises_dir
from course_lib.course.state import write_whole
from course_lib.errors import CourseError, counted
from course_lib.grading.handin.lms import TERM_TABLE
from course_lib.grading.marks.mark import need_results, results_in
from course_lib.grading.records import writing
from course_lib.grading.reports.table import csv_of, few, printable
from course_lib.grading.term.class_list import (
    ClassList,
    Member,
    read_class_list,
    read_exemptions,
    read_quizzes,
)
from course_lib.grading.term.totals import FULL, Kind, TermLine, WeekMark, add_up_term

FIXED = ("student", "name", "email", "section", "group", "total", "weeks", "quizzes")
LISTS = ("dropped", "missing", "exempt", "open", "handed_in_by")
KINDS: tuple[Kind, ...] = ("missing", "exempt", "open")
NO_MARK = ("rejected", "grader_error")
Results = Mapping[str, Mapping[str, Mapping[str, Any]]]  # by week and student


@dataclass(frozen=True)
class Files:
    """The lists that an instructor keeps beside the results; None where there is no such file.

    Args:
        roster: The class list.
        exemptions: Students and weeks that do not count for them.
        quizzes: Percent of quizzes, by student and week.
    """

    roster: Path
    exemptions: Path | None = None
    quizzes: Path | None = None


def write_term(out: Path, files: Files, course: CourseFile | None = None) -> list[str]:
    """Write OUT/term.csv; returns lines for the terminal.

    Args:
        out: The folder that `course grade` wrote.
        files: The class list, and who is exempt.
        course: Weights and deadlines; default: this checkout's.

    Raises:
        CourseError: A file is wrong, or there are no results.
    """
    course = course or read_course_file(exercises_dir() / "course.toml")
    course.demand()
    members, results = read_class_list(files.roster), _results(out)
    need_results(out)
    if course.term.quiz_percent and files.quizzes is None:
        raise CourseError(
            "course.toml counts quizzes (quiz_percent), so name their marks: --quizzes quizzes.csv, "
            "with a first line id,week,percent"
        )
    exempt = read_exemptions(files.exemptions, members, course) if files.exemptions else {}
    quizzes = read_quizzes(files.quizzes, members, course) if files.quizzes else {}
    weeks = [week for week, settings in course.weeks.items() if settings.points and week in results]
    lines = [_line(one, weeks, members, results, exempt, quizzes, course) for one in members.members]
    with writing(out):
        write_whole(out / TERM_TABLE, csv_of((*FIXED, *weeks, *LISTS), _rows(lines, members, weeks)))
    held = {week for percents in quizzes.values() for week in percents} if course.term.quiz_percent else weeks
    without = [week for week in weeks if week not in held]
    said = [f"No quiz of {few(without)} counts: nobody has a mark of it"] if without else []
    said += _said(out, lines, members, weeks, results, course)
    return [printable(line) for line in said]


def _results(out: Path) -> dict[str, dict[str, dict[str, Any]]]:
    """Return what counts of each result, by week and student."""
    found = defaultdict[str, dict[str, dict[str, Any]]](dict)
    for content in results_in(out):
        week = content["exercise"].split("_")[0]
        found[week][content["student"]] = {**content["row"], "received": content.get("received") or ""}
    return dict(found)


def _line(
    member: Member,
    weeks: Sequence[str],
    members: ClassList,
    results: Results,
    exempt: Mapping[str, Mapping[str, str]],
    quizzes: Mapping[str, Mapping[str, float]],
    course: CourseFile,
) -> TermLine:
    marks = {}
    for week in weeks:
        mine = {member.id: results[week][member.id]} if member.id in results[week] else {}
        if week in course.term.group_weeks:
            group = members.group_of(member.id)
            mine = {one.id: results[week][one.id] for one in group if one.id in results[week]}
        is_exempt = week in exempt.get(member.id, {})
        marks[week] = WeekMark("exempt") if is_exempt else week_mark(member.id, mine, course.counts)
    return TermLine(member.id, marks, add_up_term(marks, quizzes.get(member.id, {}), course.term))


def week_mark(student: str, rows: Mapping[str, Mapping[str, Any]], counts: str) -> WeekMark:
    """Return the mark of a week from the results of all who hand in together.

    Args:
        student: Whose mark it is.
        rows: Lines of the gradebook with the time of receipt, by student.
        counts: Which of several counts: the last one, by its time, or the best.
    """
    marked = {one: row for one, row in rows.items() if row["status"] not in NO_MARK}
    if not marked:
        is_ours = any(row["status"] == "grader_error" for row in rows.values())
        return WeekMark("open") if is_ours else WeekMark("missing", 0.0)
    time = "received" if counts == "last" else "final"
    by = max(marked, key=lambda one: (marked[one][time], marked[one]["final"], one))
    row = marked[by]
    percent = FULL * float(row["final"]) / float(row["max_score"])
    kind: Kind = "open" if row["status"] == "needs_marking" else "graded"
    return WeekMark(kind, percent, by if by != student else "")


def _rows(lines: Iterable[TermLine], members: ClassList, weeks: Sequence[str]) -> Iterator[Sequence[str]]:
    for line in lines:
        member, total = members.by_id[line.student], line.total
        fixed = (member.id, member.name, member.email, member.section, member.group)
        numbers = (total.percent, total.weeks, total.quizzes)
        percents = [line.marks[week].percent for week in weeks]
        by = [f"{week}:{mark.by}" for week, mark in line.marks.items() if mark.by]
        lists = [total.dropped, *(line.weeks_of(kind) for kind in KINDS), by]
        yield (*fixed, *map(_number, (*numbers, *percents)), *map(" ".join, lists))


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.10g}"


def _said(
    out: Path,
    lines: Sequence[TermLine],
    members: ClassList,
    weeks: Sequence[str],
    results: Results,
    course: CourseFile,
) -> Iterator[str]:
    """Yield who has not handed in, what is open, who is not in the class list, and a summary."""
    for week in weeks:
        zero = [line.student for line in lines if line.marks[week].kind == "missing"]
        missing = [student for student in zero if student not in results[week]]
        refused = [student for student in zero if student in results[week]]
        waiting = [line.student for line in lines if line.marks[week].kind == "open"]
        if missing:
            yield f"{week}: {counted(len(missing), 'student')} without a hand-in: {few(missing)}"
        if refused:
            yield f"{week}: {counted(len(refused), 'student')} with rejected files: {few(refused)}"
        if waiting:
            yield f"{week}: {counted(len(waiting), 'mark')} still open: {few(waiting)}"
    yield from _odd(members, weeks, results, course)
    totals = [line.total.percent for line in lines if line.total.percent is not None]
    spread = f", mean {mean(totals):.1f}, median {median(totals):.1f} percent" if totals else ""
    what = ", ".join(weeks) or "no week with points"
    yield f"Wrote {out / TERM_TABLE}: {counted(len(lines), 'student')}, {what}{spread}"


def _odd(members: ClassList, weeks: Sequence[str], results: Results, course: CourseFile) -> Iterator[str]:
    """Yield where class list, results and course.toml do not fit."""
    strangers = sorted({one for week in results.values() for one in week} - members.by_id.keys())
    if strangers:
        who = counted(len(strangers), "student")
        yield f"{who} with results, but not in the class list: {few(strangers)}"
    extended = {one for week in weeks for one in course.weeks[week].extensions}
    if unknown := sorted(extended - members.by_id.keys()):
        yield f"extensions in course.toml for IDs that are not in the class list: {few(unknown)}"
    has_groups, group_weeks = any(one.group for one in members.members), course.term.group_weeks
    if has_groups and not group_weeks:
        yield "The class list has groups, but course.toml no group_weeks: each student's own hand-in counts"
    if group_weeks and not has_groups:
        yield "course.toml has group_weeks, but the class list no groups: everybody's own counts"
