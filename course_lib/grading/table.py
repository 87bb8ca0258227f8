"""What a student sees of a result: a table, as text and as HTML."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from html import escape

from course_lib.grading.judge import CheckResult, TaskResult

PASSED_WORDS = ("✓", "passed")
FAILED_WORDS = ("✗", "failed")
ALL_PASSED = "all public checks passed; hidden checks run at grading"
FOR_A_PERSON = "noted; a person reads and marks it"
STYLE = "text-align:left;padding:0.2em 0.8em"


@dataclass(frozen=True)
class Table:
    """A task's result with a hint; Jupyter shows the HTML, a terminal the text."""

    result: TaskResult
    hint: str = ""

    def __str__(self) -> str:
        lines = [self._headline(), *(f"  {error}" for error in self.result.errors)]
        lines += [f"  {icon} {word:6}  {title}: {message}" for icon, word, title, message in self._rows()]
        return "\n".join([*lines, *self._ends()])

    def _repr_mimebundle_(self, **_: object) -> dict[str, str]:
        html = result_html(self._headline(), self.result.errors, self._rows(), self._ends())
        return {"text/html": html, "text/plain": str(self)}

    def _headline(self) -> str:
        done = sum(check.passed for check in self.result.checks)
        return f"{self.result.task} ({self.result.title}): {done} of {len(self.result.checks)} checks passed"

    def _rows(self) -> list[tuple[str, str, str, str]]:
        return list(rows(self.result.checks))

    def _ends(self) -> list[str]:
        if not self.result.checks:
            return [FOR_A_PERSON]
        return [self.hint] if self.hint else [ALL_PASSED] if self.result.passed else []


def rows(checks: Iterable[CheckResult]) -> Iterator[tuple[str, str, str, str]]:
    """Icon, word, title and message of each check, as students may read them."""
    number = 0
    for check in checks:
        icon, word = PASSED_WORDS if check.passed else FAILED_WORDS
        if 0 < check.score < 1:
            word = f"{check.score:.0%}"
        number += check.hidden
        if check.hidden:
            yield icon, word, f"hidden check {number}", check.mistake
        else:
            yield icon, word, check.title, check.message


def result_html(
    headline: str, errors: Iterable[str], lines: Iterable[tuple[str, str, str, str]], ends: Iterable[str]
) -> str:
    """The table as HTML; every text in it is escaped."""
    body = "".join(
        f'<tr><td style="{STYLE}">{icon} {word}</td><th scope="row" style="{STYLE};font-weight:normal">'
        f'{escape(title)}</th><td style="{STYLE}">{escape(message)}</td></tr>'
        for icon, word, title, message in lines
    )
    head = "".join(f'<th scope="col" style="{STYLE}">{name}</th>' for name in ("result", "check", "why"))
    above = "".join(f"<p><code>{escape(error)}</code></p>" for error in errors)
    below = "".join(f"<p>{escape(end)}</p>" for end in ends)
    table = f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    return f"<div><p><strong>{escape(headline)}</strong></p>{above}{table}{below}</div>"
