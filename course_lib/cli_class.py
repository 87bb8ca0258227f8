"""`course …` for a class: reports back to students, other platforms, and a term's marks."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

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
    """Write the reports as the zip that Moodle's or Canvas's bulk upload takes, one per exercise."""
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
    """Write an autograder.zip for Gradescope, which grades a week's exercise at upload."""
    from course_lib.grading.platforms.gradescope import write_autograder
    from course_lib.grading.platforms.harness import grade_upload

    need: Need = "full" if require_sandbox else "any" if trust else "partial"
    if run is not None:
        typer.echo(f"Wrote {grade_upload(week, run, hidden=hidden, need=need)}")
        return
    for line in write_autograder(week, out, hidden=hidden, need=need, roster=roster):
        typer.echo(line)
