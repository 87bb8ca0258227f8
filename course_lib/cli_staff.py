"""`course …` for instructors: every command calls one function of the library."""

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from course_lib.cli_author import authors
from course_lib.cli_class import classes
from course_lib.errors import CourseError

if TYPE_CHECKING:
    from course_lib.grading.jail.isolation import Need

NOT_PASSED = 1  # exit code
_FORKING = {"check", "classroom", "collect", "grade", "mark", "regrade", "verify"}  # run or keep submissions

staff = typer.Typer()
staff.add_typer(authors)
staff.add_typer(classes)


def need_fork_for(command: str) -> None:
    """Refuse a command that forks processes where the system cannot, as on native Windows.

    Raises:
        CourseError: It is one that runs or keeps submissions, and processes cannot fork here.
    """
    if command in _FORKING and not hasattr(os, "fork"):
        instead = " In the exercise itself check() works without." if command == "check" else ""
        raise CourseError(
            f"course {command} needs Linux, macOS or WSL2: on this system ({sys.platform}) a process can't "
            f"fork.{instead}"
        )


@staff.command()
def collect(
    source: Annotated[Path, typer.Argument(help="A folder or zip, as Moodle, Canvas or nbgrader gave it.")],
    out: Annotated[Path, typer.Option(help="Where the submissions go: a folder per student.")],
    roster: Annotated[
        Path | None, typer.Option(help="The platform's CSV, to name students by an ID in it.")
    ] = None,
    id_column: Annotated[
        str, typer.Option(help="The heading of that ID in --roster; default: found by what is in it.")
    ] = "",
    times: Annotated[
        list[Path] | None,
        typer.Option(help="More times of submission: CSV, or JSON of Canvas's API; may be given again."),
    ] = None,
    time_zone: Annotated[
        str, typer.Option(help="The zone of the platform's times; default: the course's.")
    ] = "",
) -> None:
    """Sort what a learning platform gives into submissions; what is unsafe is refused, one by one."""
    from course_lib.course.course_file import shipped_course_file, zone_named
    from course_lib.grading.handin.collect import collect as sort

    course = shipped_course_file()
    zone = zone_named(time_zone) if time_zone else course.zone
    done = sort(source, out, zone, roster, id_column, times or ())
    if course.zone_note and not time_zone:
        typer.echo(course.zone_note)
    for line in (*done.refused, *sorted(done.notes), done.summary(out)):
        typer.echo(line)
    raise typer.Exit(NOT_PASSED if done.refused else 0)


@staff.command()
def grade(
    submissions: Annotated[Path, typer.Argument(help="The folder with the submissions.")],
    out: Annotated[Path, typer.Option(help="Where results, gradebook and reports go.")],
    jobs: Annotated[int | None, typer.Option(min=1, help="Submissions at a time.")] = None,
    only: Annotated[str, typer.Option(help="What to grade, a pattern like 'ada/*'.")] = "*",
    resume: Annotated[bool, typer.Option("--resume", help="Leave out what is graded already.")] = False,
    rejudge: Annotated[
        bool, typer.Option("--rejudge", help="Judge stored evidence again, without running anything.")
    ] = False,
    dask: Annotated[str | None, typer.Option(help="Run on the workers of this Dask scheduler.")] = None,
    require_sandbox: Annotated[
        bool, typer.Option("--require-sandbox", help="Refuse to run submissions in less than a full sandbox.")
    ] = False,
    trust: Annotated[
        bool, typer.Option("--i-trust-these-submissions", help="Run them with your rights if need be.")
    ] = False,
) -> None:
    """Grade a folder of submissions: results, gradebook.csv and one report per student."""
    from course_lib.grading.grade import grade as grade_all

    need: Need = "full" if require_sandbox else "any" if trust else "partial"
    passed = grade_all(
        submissions, out, jobs=jobs, dask=dask, only=only, resume=resume, rejudge=rejudge, need=need
    )
    raise typer.Exit(0 if passed else NOT_PASSED)


@staff.command()
def mark(
    out: Annotated[Path, typer.Argument(help="Where `course grade` put gradebook.csv.")],
    given: Annotated[
        list[str] | None, typer.Argument(metavar="[STUDENT EXERCISE TASK POINTS]", help="By hand.")
    ] = None,
    row: Annotated[str, typer.Option(help="Of the rubric: its number, or how it begins.")] = "",
    comment: Annotated[str, typer.Option(help="For the student's report.")] = "",
    lms: Annotated[
        Path | None, typer.Option(help="The CSV that Canvas, Moodle or another platform exported, to fill.")
    ] = None,
    exercise: Annotated[str, typer.Option(help="With --lms: whose marks, week01_exercise.")] = "",
    column: Annotated[str, typer.Option(help="With --lms: the heading of the column to fill.")] = "",
    id_column: Annotated[str, typer.Option(help="With --lms: the heading of the students' IDs.")] = "",
    to: Annotated[Path | None, typer.Option(help="With --lms: write it here, otherwise unchanged.")] = None,
    raw: Annotated[bool, typer.Option("--raw", help="The scores before the late policy.")] = False,
    cap: Annotated[
        bool, typer.Option("--cap", help="No mark above the platform's maximum, where it refuses a bonus.")
    ] = False,
    serve: Annotated[bool, typer.Option("--serve", help="Mark in the browser, on this machine.")] = False,
    port: Annotated[int | None, typer.Option(min=0, help="With --serve: where to listen.")] = None,
    browser: Annotated[bool, typer.Option(help="With --serve: open the page.")] = True,
) -> None:
    """Enter points by hand, which grading again keeps; or fill one column of a learning platform's CSV."""
    if serve and lms is None and not given:
        from course_lib.grading.marking.server import serve as serve_page

        serve_page(out, port=port, browser=browser)
        return
    if lms is not None and to is not None and exercise and column and id_column and not given:
        from course_lib.grading.handin.lms import fill_lms

        names = {"exercise": exercise, "column": column, "id_column": id_column}
        lines = fill_lms(out, lms, to, **names, raw=raw, cap=cap)
    else:
        lines = [_mark(out, given or (), row, comment, is_lms=lms is not None)]
    for line in lines:
        typer.echo(line)


def _mark(out: Path, given: Sequence[str], row: str, comment: str, *, is_lms: bool) -> str:
    """Store the points that are given; without any, write reports and gradebook of those that are there."""
    from course_lib.grading.marking.follow import follow_marks
    from course_lib.grading.marks.by_hand import mark_by_hand

    if not is_lms and not (given or row or comment):
        return follow_marks(out)
    if not is_lms and len(given) == len(("STUDENT", "EXERCISE", "TASK", "POINTS")):
        return mark_by_hand(out, *given, row=row, comment=comment)
    raise CourseError(
        "write: course mark OUT --serve; or: course mark OUT STUDENT EXERCISE TASK POINTS [--row ROW] "
        "[--comment TEXT]; or: course mark OUT --lms CSV --exercise E --column C --id-column I --to CSV"
    )
