"""Results as text and HTML: a student's table, and lines for the terminal."""

import csv
import io
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_lib.grading.judge import CheckResult, TaskResult

if TYPE_CHECKING:
    from jinja2 import Environment

ALL_PASSED = "all public checks passed; hidden checks run at grading"
FORMULA_STARTS = ("=", "+", "-", "@", "\t", "\r", "\n")
FOR_A_PERSON = "noted; a person reads and marks it"
_WILD = re.compile(r"\x1b\[[0-?]*[ -/]*[@-~]|[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")


@dataclass(frozen=True)
class Table:
    """A task's result with lines below it, as HTML for Jupyter and as text for a terminal.

    Args:
        result: Of the task.
        notes: Below its checks.
        printed: What the student's code printed, line by line.
    """

    result: TaskResult
    notes: tuple[str, ...] = ()
    printed: tuple[str, ...] = ()

    def __str__(self) -> str:
        lines = [f"{icon} {word:6}  {title}: {why}" for icon, word, title, why in rows(self.result.checks)]
        above = "\n  ".join([self._headline(), *self.result.errors, *lines])
        below = ["It printed:", *(f"  | {line}" for line in self.printed)] if self.printed else []
        return "\n".join([above, *below, *self._end()])

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        shown = {"headline": self._headline(), "errors": self.result.errors, "end": self._end()}
        printed = "\n".join(self.printed)
        html = fill("result.html", rows=rows(self.result.checks), printed=printed, **shown)
        return {"text/html": html, "text/plain": str(self)}

    def _headline(self) -> str:
        done = sum(check.passed for check in self.result.checks)
        return f"{self.result.task} ({self.result.title}): {done} of {len(self.result.checks)} checks passed"

    def _end(self) -> list[str]:
        verdict = ALL_PASSED if self.result.checks else FOR_A_PERSON
        return [*self.notes, *([verdict] if self.result.passed else [])]


Row = tuple[str, str, str, str]  # icon, word, title, reason


def rows(checks: Iterable[CheckResult]) -> list[Row]:
    """Return icon, word, title and reason of each check; of a hidden one its number and kind of mistake.

    Public checks that fail for one reason share a row.
    """
    return [row for _, row in scored_rows(checks)]


def scored_rows(checks: Iterable[CheckResult]) -> list[tuple[float, Row]]:
    """Return the rows, each with the score of its checks."""
    made: dict[tuple[str, ...], tuple[float, Row]] = {}
    hidden = 0
    for check in checks:
        icon, word = ("✓", "passed") if check.passed else ("✗", "failed")
        if 0 < check.score < 1:
            word = f"{check.score:.0%}"
        hidden += check.hidden
        said = (f"hidden check {hidden}", check.mistake) if check.hidden else (check.title, check.message)
        title, why = said
        shares = not check.passed and not check.hidden and why
        key = (word, why) if shares else (title, str(len(made)))
        title = f"{made[key][1][2]}; {title}" if key in made else title
        made[key] = (check.score, (icon, word, title, why))
    return list(made.values())


def gone_lines(results: Iterable[Mapping[str, Any]], submissions: Path, out: Path) -> list[str]:
    """Return whose marks still count, though the file is no longer in the folder of submissions."""
    files = {Path(one["file"]): f"{one['student']} {one['exercise']}" for one in results}
    gone = [one for file, one in files.items() if not file.exists() and submissions in file.parents]
    todo = f"Moved or withdrawn? Remove {out / 'results'}/STUDENT/EXERCISE.json, then grade again"
    return [f"Look at: no file any more, but its mark counts: {few(gone)}. {todo}"] if gone else []


def fill(template: str, **values: Any) -> str:
    """Return a page of templates/, in which every text is escaped."""
    return _templates().get_template(template).render(values)


def harmless(value: Any) -> Any:
    """Put an apostrophe before a text that a spreadsheet would take for a formula."""
    return f"'{value}" if isinstance(value, str) and value.startswith(FORMULA_STARTS) else value


def csv_of(columns: Iterable[str], rows: Iterable[Iterable[Any]]) -> bytes:
    """Return a CSV file in which no text is a formula; half of a surrogate pair becomes a question mark."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(map(harmless, row) for row in rows)
    return text.getvalue().encode("utf-8", "replace")


def printable(line: str) -> str:
    """Replace control characters and broken ones: a student's name may hold anything."""
    return "".join(c if c.isprintable() else "�" for c in line.encode("utf-8", "replace").decode())


@lru_cache(maxsize=1)
def _templates() -> "Environment":
    from jinja2 import Environment, FileSystemLoader

    loader = FileSystemLoader(Path(__file__).with_name("templates"))
    return Environment(loader=loader, autoescape=True, finalize=tame)


def tame(value: Any) -> Any:
    """Remove terminal colours, control characters and changes of the reading direction from a text."""
    return _WILD.sub("", value) if type(value) is str else value  # not what is markup already


Line = Mapping[str, Any]  # of the gradebook
MOST_NAMED = 5  # students in a line
NO_REPORT = "No report could be written"
MEND = "Correct the check, then grade with --rejudge; or give the task's points with `course mark`."


def watched(rows: Iterable[Line], total: int) -> Iterator[Line]:
    """Yield the rows, with a progress bar in the terminal and a line for each problem above it."""
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


def counts(rows: Iterable[Line]) -> str:
    """Return the number of rows of each status, as a sentence."""
    return ", ".join(f"{n} {status}" for status, n in sorted(Counter(row["status"] for row in rows).items()))


def task_lines(results: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return a line per task that checks mark: number of results, mean, and number of full marks."""
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
    return [f"A check could not judge {few(students)}: {what}. {MEND}" for what, students in met.items()]


def lost_report_lines(results: Iterable[Mapping[str, Any]]) -> list[str]:
    """Return a line for each reason for which pages could not be written, with their students."""
    lost: dict[str, list[str]] = {}
    for result in results:
        for note in (note for note in result["notes"] if note.startswith(NO_REPORT)):
            lost.setdefault(note, []).append(result["student"])
    return [f"{note} ({few(students)}). The marks are right." for note, students in lost.items()]


def few(students: Sequence[str]) -> str:
    """Return the first names of a list, and how many there are besides."""
    shown = ", ".join(students[:MOST_NAMED])
    return shown + f" and {len(students) - MOST_NAMED} more" * (len(students) > MOST_NAMED)
