"""What the terminal shows while a class is graded: a bar, a line per problem, a summary."""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from course_lib.grading.table import printable

Row = Mapping[str, Any]  # of the gradebook
MOST_NAMED = 5  # students in a line
MEND = "Correct the check, then grade with --rejudge; or give the task's points with `course mark`."


def watched(rows: Iterable[Row], total: int) -> Iterator[Row]:
    """The same rows, while a bar with rate and time left tells how far it is; problems go above it."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    rate, columns = TextColumn("{task.fields[rate]}"), (BarColumn(), MofNCompleteColumn())
    with Progress(TextColumn("Grading"), *columns, rate, TimeRemainingColumn()) as progress:
        bar = progress.add_task("", total=total, rate="")
        for row in rows:
            if row["status"] != "graded":
                words = (str(row[name]) for name in ("student", "exercise", "status", "reason", "message"))
                line = printable("  ".join(words))
                progress.console.print(line, markup=False, highlight=False, soft_wrap=True)
            progress.advance(bar)
            progress.update(bar, rate=f"{progress.tasks[bar].speed or 0:.1f}/s")
            yield row


def say(line: str) -> None:
    """Print a line."""
    print(printable(line))  # noqa: T201  the terminal is its page


def counts(rows: Iterable[Row]) -> str:
    """How many there are of each status."""
    return ", ".join(f"{n} {status}" for status, n in sorted(Counter(row["status"] for row in rows).items()))


def task_lines(results: Iterable[Mapping[str, Any]]) -> list[str]:
    """A line per task that checks mark, of all results: how many, the mean, how many have full marks."""
    scores: dict[str, list[float]] = {}
    points: dict[str, float] = {}
    for result in results:
        for task in (task for task in result.get("tasks", ()) if not task["rubric"]):
            scores.setdefault(task["task"], []).append(task["score"])
            points[task["task"]] = task["points"]
    return [
        f"{task:30} {len(got):5} graded  mean {sum(got) / len(got):5.1f} of {points[task]:g}  "
        f"{sum(score >= points[task] for score in got)} with full marks"
        for task, got in sorted(scores.items())
    ]


def broken_lines(results: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return a line for each check that raised an exception, with the submissions that it did not judge."""
    met: dict[str, list[str]] = {}
    for result in results:
        for task in result.get("tasks", ()):
            for check in (check for check in task["checks"] if check.get("broken")):
                what = f"{task['task']}, {check['scenario']}, {check['title']!r}: {check['broken']}"
                met.setdefault(what, []).append(result["student"])
    return [f"A check could not judge {_few(students)}: {what}. {MEND}" for what, students in met.items()]


def _few(students: list[str]) -> str:
    shown = ", ".join(students[:MOST_NAMED])
    return shown + f" and {len(students) - MOST_NAMED} more" * (len(students) > MOST_NAMED)
