"""`course …` for authors: verify and release; every command calls one function of the library."""

from pathlib import Path
from typing import Annotated

import typer

NOT_READY = 1  # exit code

authors = typer.Typer()


@authors.command()
def new(
    kind: Annotated[str, typer.Argument(help="week09, or the word course.")],
    title: Annotated[str, typer.Argument(help='Its title: "Occupancy maps".')],
) -> None:
    """Write the files of a week, or of a course of your own, which already run."""
    from course_lib.authoring.new_course import new_course
    from course_lib.authoring.new_week import new_week
    from course_lib.grading.records import this_course

    if kind == "course":
        root = new_course(title, Path.cwd())
        typer.echo(
            f"{root} is a course. Go on there: pip install -e '.[test]' && course verify && course lab"
        )
        return
    for path in new_week(kind, title, this_course()):
        typer.echo(path)
    typer.echo(f"It runs as it is. Replace what says REPLACE, and look often: course verify {kind}")


@authors.command()
def verify(
    weeks: Annotated[list[str] | None, typer.Argument(help="week09 …; default: all.")] = None,
    jobs: Annotated[int | None, typer.Option(min=1, help="Notebooks that run at a time.")] = None,
) -> None:
    """Try the answers of each week, its checks, quiz and lesson, before students do."""
    from rich.console import Console

    from course_lib.authoring.memory import remember
    from course_lib.authoring.verify import lines, table
    from course_lib.authoring.verify import verify as look
    from course_lib.grading.records import this_course

    course, reports = this_course(), []
    for report in look(course, weeks or (), jobs):
        typer.echo(f"{report.week}: {len(report.flaws) or 'nothing'} to correct", err=True)
        reports.append(report)
    remember(course, reports)
    Console().print(table(reports))
    typer.echo("\n".join(lines(reports, course)))
    raise typer.Exit(NOT_READY if any(report.flaws for report in reports) else 0)


@authors.command()
def release(out: Annotated[Path, typer.Argument(help="An empty or new folder.")]) -> None:
    """Write the students' copy: installable, without solutions and hidden checks. Verify first."""
    from course_lib.authoring.memory import refuse_broken
    from course_lib.authoring.verify import left_in
    from course_lib.course.hand_out import free_place
    from course_lib.course.hand_out import release as write
    from course_lib.grading.records import this_course

    free_place(out)
    refuse_broken(this_course())
    paths = write(out)
    for line in left_in(this_course()):
        typer.echo(f"note: {line}")
    typer.echo(f"Released {len(paths)} parts into {out}. Students run there: pip install -e . && course lab")


@authors.command()
def book(out: Annotated[Path, typer.Argument(help="A new or empty folder, or a former book.")]) -> None:
    """Build the course's lessons and guides as web pages, with their scenes; they need no network."""
    from course_lib.book.book import build

    made = build(out, typer.echo)
    typer.echo(f"{made.index}: {made.pages} pages")
    typer.echo("\n".join(made.warnings), err=True, nl=bool(made.warnings))
    raise typer.Exit(NOT_READY if made.warnings else 0)
