"""The grammar of texts in XML and YAML launch files, with `$(name argument 'another argument')` in them."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NoReturn

from course_lib.errors import did_you_mean
from launch.entities import Substitution
from launch.substitutions import TextSubstitution

Parts = list[Substitution]
_DEEPEST = 50  # substitutions in one another
_NAME = re.compile(r"[A-Za-z][\w-]*")
# By the quote that the text stands in: what is text there, and what is text as an argument without quotes.
_STRING = {quote: re.compile(rf"(?:\\.|[^$\\{quote}]|\\|\$(?!\())+", re.DOTALL) for quote in ("", "'", '"')}
_WORD = {
    "": re.compile(r"(?:\\[()$'\"\\]|\\|[^ '\"\\$()]|\$(?!\())+"),
    "'": re.compile(r"(?:\\[()$'\\]|\\|[^ '\\$()]|\$(?!\())+"),
    '"': re.compile(r"(?:\\[()$\"\\]|\\|[^ \"\\$()]|\$(?!\())+"),
}
_OF_ROS_1 = {"arg": "var", "find": "find-pkg-share", "optenv": "env"}


@dataclass(frozen=True)
class Form:
    """One substitution of launch files: what makes it of its arguments, and how many these are."""

    make: Callable[..., Substitution]
    least: int = 0
    most: int | None = 0


SUBSTITUTIONS: dict[str, Form] = {}


def parse_substitution(text: str) -> Parts:
    """Parse a text with `$(…)`; raises ValueError that shows where it is wrong."""
    if not text:
        return [TextSubstitution(text="")]
    reader = _Reader(text)
    parts = reader.template("")
    if reader.at < len(text):
        reader.fail("the end")
    return parts


def unescaped(text: str) -> str:
    r"""Return a text with `\(` and the like replaced by the character itself."""
    return re.sub(r"\\(.)", r"\1", text)


class _Reader:
    """Reads a text from `at` on."""

    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0
        self._depth = 0

    def template(self, quote: str) -> Parts:
        """Read texts and substitutions up to the quote that ends them, or to the end."""
        return self._parts(_STRING[quote], quote)

    def fail(self, expected: str) -> NoReturn:
        """Raise ValueError."""
        rest = self.text[self.at : self.at + 20]
        found = f"found {rest!r}" if rest else "the text ends"
        raise ValueError(f"{self.text!r}, character {self.at + 1}: expected {expected}, {found}")

    def _parts(self, pattern: re.Pattern[str], quote: str) -> Parts:
        parts: Parts = []
        while True:
            if self.text.startswith("$(", self.at):
                parts.append(self._substitution(quote))
            elif match := pattern.match(self.text, self.at):
                self.at = match.end()
                parts.append(TextSubstitution(text=unescaped(match[0])))
            else:
                return parts

    def _substitution(self, quote: str) -> Substitution:
        begin = self.at
        self.at += 2
        name = _NAME.match(self.text, self.at)
        if name is None:
            self.fail("the name of a substitution, as in $(var x)")
        self.at = name.end()
        arguments: list[Parts] = []
        self._depth += 1
        if self._depth > _DEEPEST:
            raise ValueError(f"more than {_DEEPEST} substitutions are nested in {self.text[:40]!r}…")
        while self._takes(" "):
            arguments.append(self._argument(quote))
        self._depth -= 1
        if not self._takes(")"):
            self.fail("')', or one space and an argument; put quotes around one with spaces")
        return _made(name[0], arguments, self.text[begin : self.at])

    def _argument(self, quote: str) -> Parts:
        opening = self.text[self.at : self.at + 1]
        if not quote and opening and opening in "'\"":
            self.at += 1
            parts = self.template(opening)
            if not self._takes(opening):
                self.fail(f"the quote {opening} that ends the argument")
            return parts
        parts = self._parts(_WORD[quote], quote)
        if not parts:
            self.fail("an argument; between two there is one space")
        return parts

    def _takes(self, character: str) -> bool:
        taken = self.text.startswith(character, self.at)
        self.at += taken
        return taken


def _made(name: str, arguments: Sequence[Parts], text: str) -> Substitution:
    form = SUBSTITUTIONS.get(name)
    if form is None:
        known = [*SUBSTITUTIONS]
        hint = did_you_mean(name, known) or f". There are: {', '.join(sorted(known))}"
        if name in _OF_ROS_1:
            hint = f". In ROS 2 write $({_OF_ROS_1[name]} …)"
        raise ValueError(f"{text}: there is no substitution '{name}'{hint}")
    if len(arguments) < form.least or (form.most is not None and len(arguments) > form.most):
        most = "more" if form.most is None else form.most
        expected = form.least if form.least == form.most else f"{form.least} to {most}"
        raise ValueError(
            f"{text}: {name} has {len(arguments)} arguments, expected {expected}. Arguments with spaces "
            "stand in quotes"
        )
    return form.make(*arguments)
