"""A result as text and HTML, templates of pages, and strings for files and terminals."""

import csv
import io
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from course_lib.grading.records import CheckResult, TaskResult

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup

ALL_PASSED = "all public checks passed; hidden checks run at grading"
# Some spreadsheets also interpret the full-width forms of the first four.
FORMULA_STARTS = ("=", "+", "-", "@", "\t", "\r", "\n", "\uff1d", "\uff0b", "\uff0d", "\uff20")
FOR_A_PERSON = "recorded; a person reads and marks it"
_WILD = re.compile(r"\x1b\[[0-?]*[ -/]*[@-~]|[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")


@dataclass(frozen=True)
class Table:
    """A task's result with notes below it, as HTML for Jupyter and as text for a terminal.

    Args:
        result: The task's result.
        notes: Lines below the checks.
        printed: Lines that the student's code printed.
        next_step: What to do after a task that has passed.
    """

    result: TaskResult
    notes: tuple[str, ...] = ()
    printed: tuple[str, ...] = ()
    next_step: str = ""

    def __str__(self) -> str:
        lines = [f"{r.icon} {r.state:6}  {r.title}: {r.reason}" for r in rows(self.result.checks)]
        above = "\n  ".join([self._headline(), *self.result.errors, *lines])
        below = ["It printed:", *(f"  | {line}" for line in self.printed)] if self.printed else []
        return "\n".join([above, *below, *self.notes, *self._success()])

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        content = {"headline": self._headline(), "errors": self.result.errors, "end": self.notes}
        printed = "\n".join(self.printed)
        html = fill(
            "result.html",
            rows=rows(self.result.checks),
            printed=printed,
            success=self._success(),
            **content,
        )
        return {"text/html": html, "text/plain": str(self)}

    def _headline(self) -> str:
        passed_count = sum(check.passed for check in self.result.checks)
        return (
            f"{self.result.task} ({self.result.title}): {passed_count} of "
            f"{len(self.result.checks)} checks passed"
        )

    def _success(self) -> list[str]:
        """Return the lines about a passed task: the verdict, then its points and the next step."""
        if not self.result.passed:
            return []
        if self.result.rubric or not self.result.checks:
            verdict, points = FOR_A_PERSON, []
        else:
            verdict = ALL_PASSED
            points = [f"This task: {self.result.score:g} of {self.result.points:g} points so far."]
        return [verdict, *([" ".join([*points, self.next_step])] if self.next_step else [])]


class CheckRow(NamedTuple):
    """A row of the table: a check, or several that fail for the same reason."""

    icon: str
    # "passed", "failed" or the score.
    state: str
    title: str
    reason: str


def rows(checks: Iterable[CheckResult]) -> list[CheckRow]:
    """Return the icon, state, title and reason of each check.

    A hidden check has only a number and its mistake.

    Public checks that fail for the same reason share a row.
    """
    return [row for _, row in scored_rows(checks)]


def scored_rows(
    checks: Iterable[CheckResult],
    *,
    show_hidden: bool = False,
) -> list[tuple[float, CheckRow]]:
    """Return the rows with the scores of their checks; `show_hidden` reveals hidden checks."""
    rows_by_key: dict[tuple[str, ...], tuple[float, CheckRow]] = {}
    hidden_count = 0
    for check in checks:
        icon, word = ("✓", "passed") if check.passed else ("✗", "failed")
        if 0 < check.score < 1:
            word = f"{check.score:.0%}"
        hidden_count += check.is_hidden
        is_masked = check.is_hidden and not show_hidden
        texts = (f"hidden check {hidden_count}", check.mistake) if is_masked else (check.title, check.message)
        title, why = texts
        title = f"{title} (hidden)" if check.is_hidden and show_hidden else title
        shares = not check.passed and not check.is_hidden and why
        key = (word, why) if shares else (title, str(len(rows_by_key)))
        if key in rows_by_key:
            # A scenario that the title shares with the last title of the row is left out.
            titles, (scenario, _, rest) = rows_by_key[key][1].title, title.rpartition(": ")
            is_shared = scenario and titles.rpartition("; ")[2].startswith(f"{scenario}: ")
            title = f"{titles}, {rest}" if is_shared else f"{titles}; {title}"
        rows_by_key[key] = (check.score, CheckRow(icon, word, title, why))
    return list(rows_by_key.values())


def fill(template: str, **values: Any) -> str:
    """Render a page of templates/, escaping every text."""
    return _templates().get_template(template).render(values)


def escape_formula(value: Any) -> Any:
    """Put an apostrophe before a string that a spreadsheet would interpret as a formula."""
    return f"'{value}" if isinstance(value, str) and value.startswith(FORMULA_STARTS) else value


def csv_of(columns: Iterable[str], rows: Iterable[Iterable[Any]]) -> bytes:
    """Return a CSV file without formulas and control characters.

    A terminal obeys control characters if somebody prints the file. Lone surrogates become question
    marks.
    """
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    # A character that is removed may hide the first one of a formula.
    writer.writerows(map(escape_formula, map(strip_control_characters, row)) for row in rows)
    return text.getvalue().encode("utf-8", "replace")


# No-break and ideographic spaces and joiners, as in Japanese and Persian names.
INVISIBLE_IN_NAMES = "\u00a0\u202f\u3000\u200c\u200d"


def replace_controls(line: str) -> str:
    """Replace control characters and lone surrogates; a student's name may contain anything."""
    text = line.encode("utf-8", "replace").decode()
    return "".join(c if c.isprintable() or c in INVISIBLE_IN_NAMES else "�" for c in text)


@lru_cache(maxsize=1)
def _templates() -> "Environment":
    from jinja2 import Environment, FileSystemLoader

    loader = FileSystemLoader(Path(__file__).with_name("templates"))
    environment = Environment(loader=loader, autoescape=True, finalize=strip_control_characters)
    environment.globals["content_policy"] = _policy
    environment.filters["code"] = _mark_code
    return environment


def _mark_code(text: str) -> "Markup":
    """Escape a text as HTML, with the parts between backticks as code."""
    from markupsafe import Markup, escape

    return Markup(re.sub("`([^`]+)`", r"<code>\1</code>", str(escape(strip_control_characters(text)))))


def _policy(script: str, has_scenes: object, loads_viewer: object) -> str:
    """Return the content security policy of a page with one script, or without ("")."""
    from course_lib.viewer.html import content_policy

    scripts = [str(script)] if script else []
    return content_policy(*scripts, has_scenes=bool(has_scenes), loads_viewer=bool(loads_viewer))


def strip_control_characters(value: Any) -> Any:
    """Remove terminal colors, control characters and directional marks from a string."""
    return _WILD.sub("", value) if type(value) is str else value  # markup is escaped already


MOST_NAMED = 5  # limit on the students that a line lists


def print_line(line: str) -> None:
    """Print a line with control characters replaced."""
    print(replace_controls(line))  # noqa: T201


def join_few(students: Sequence[str]) -> str:
    """Return the first names of a list, and the number of the others."""
    named_students = ", ".join(students[:MOST_NAMED])
    return named_students + f" and {len(students) - MOST_NAMED} more" * (len(students) > MOST_NAMED)
