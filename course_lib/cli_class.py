"""`course …` for a class: reports back to students, other platforms, and a term's marks."""

from pathlib import Path
from typing import Annotated

import typer

NOT_PASSED = 1  # exit code

classes = typer.Typer()

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
