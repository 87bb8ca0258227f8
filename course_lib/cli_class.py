"""`course …` for a class: reports back to students, other platforms, and a term's marks."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from course_lib.errors import CourseError

if TYPE_CHECKING:
    from course_lib.grading.jail.isolation import Need

NOT_PASSED = 1  # exit code

classes = typer.Typer()

Roster = Annotated[Path | None, typer.Option(help="The class list: id,name,email,section,group,login.")]
Graded = Annotated[Path, typer.Argument(help="Where `course grade` put gradebook.csv.")]


@classes.command()
def feedback(
    out: Graded,
    lms: Annotated[str, typer.Option(help="moodle or canvas.")],
) -> None:
    """Pack the reports for Moodle's or Canvas's bulk upload, a zip per exercise."""
    from course_lib.grading.reports.feedback import feedback as write

    for line in write(out, lms):
        typer.echo(line)


@classes.command()
def gradescope(
    week: Annotated[str, typer.Argument(help="week01.")],
    out: Annotated[Path, typer.Option(help="The zip to upload to Gradescope.")] = Path("autograder.zip"),
    roster: Roster = None,
    hidden: Annotated[
        str, typer.Option(help="When students see hidden checks: after_published, after_due_date, hidden.")
    ] = "after_published",
    run: Annotated[Path | None, typer.Option(help="Grade the submission in Gradescope's folder.")] = None,
    require_sandbox: Annotated[
        bool, typer.Option("--require-sandbox", help="Refuse to run submissions in less than a full sandbox.")
    ] = False,
    trust: Annotated[
        bool, typer.Option("--i-trust-these-submissions", help="Run them with its rights if need be.")
    ] = False,
) -> None:
    """Write an autograder for Gradescope, of one week."""
    from course_lib.grading.platforms.gradescope import write_autograder
    from course_lib.grading.platforms.harness import grade_upload

    need: Need = "full" if require_sandbox else "any" if trust else "partial"
    if run is not None:
        typer.echo(f"Wrote {grade_upload(week, run, hidden=hidden, need=need)}")
        return
    for line in write_autograder(week, out, hidden=hidden, need=need, roster=roster):
        typer.echo(line)


@classes.command()
def term(
    out: Graded,
    roster: Annotated[Path, typer.Option(help="The class list: id,name,email,section,group,login.")],
    exemptions: Annotated[Path | None, typer.Option(help="A CSV: id,week,reason.")] = None,
    quizzes: Annotated[Path | None, typer.Option(help="A CSV, if quizzes count: id,week,percent.")] = None,
) -> None:
    """Add up the term: term.csv, and who has not handed in."""
    from course_lib.grading.term.term import Files, write_term

    for line in write_term(out, Files(roster, exemptions, quizzes)):
        typer.echo(line)


@classes.command()
def regrade(
    out: Graded,
    about: Annotated[
        list[str] | None, typer.Argument(metavar="[STUDENT EXERCISE]", help="To answer.")
    ] = None,
    answer: Annotated[str, typer.Option(help="The answer, which the report shows.")] = "",
    requests: Annotated[
        Path | None, typer.Option(help="A folder of STUDENT/week01_exercise.txt, to enter.")
    ] = None,
) -> None:
    """Enter, list or answer requests to look at a mark again."""
    from course_lib.grading.term.regrade import answer as reply
    from course_lib.grading.term.regrade import take_in, waiting

    if requests is not None and not about and not answer:
        lines = take_in(out, requests)
    elif requests is None and answer and about and len(about) == len(("STUDENT", "EXERCISE")):
        lines = reply(out, about[0], about[1], answer)
    elif requests is None and not about and not answer:
        lines = waiting(out)
    else:
        raise CourseError(
            "write: course regrade OUT; or: course regrade OUT --requests FOLDER; "
            'or: course regrade OUT STUDENT EXERCISE --answer "TEXT"'
        )
    for line in lines:
        typer.echo(line)


@classes.command()
def classroom(
    copy: Annotated[
        Path | None, typer.Argument(help="The students' copy, which gets a workflow of GitHub Actions.")
    ] = None,
    clones: Annotated[Path | None, typer.Option(help="The clones of students' repositories.")] = None,
    roster: Roster = None,
    pushes: Annotated[Path | None, typer.Option(help="With --clones: JSON of GitHub's activity.")] = None,
    out: Annotated[Path, typer.Option(help="With --clones: where the submissions go.")] = Path("submissions"),
    check: Annotated[Path | None, typer.Option(help="Run the public checks of what has changed.")] = None,
) -> None:
    """Check each push to GitHub; or sort clones into submissions."""
    from course_lib.grading.platforms.classroom import check_changed, collect_clones, write_workflow

    if check is not None and copy is None and clones is None:
        raise typer.Exit(0 if check_changed(check) else NOT_PASSED)
    if clones is not None and roster is not None and copy is None and check is None:
        lines = collect_clones(clones, out, roster, pushes)
    elif copy is not None and clones is None and check is None:
        lines = write_workflow(copy)
    else:
        raise CourseError(
            "write: course classroom COPY; or: course classroom --clones DIR --roster roster.csv "
            "--pushes pushes.json --out submissions"
        )
    for line in lines:
        typer.echo(line)
    raise typer.Exit(NOT_PASSED if any(line.startswith("refused") for line in lines) else 0)
