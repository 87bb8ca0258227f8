"""The grammar of substitutions in launch files: `$(name argument 'another argument')`."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import NoReturn

from course_lib.errors import did_you_mean
from launch.entities import Substitution
from launch.substitutions import TextSubstitution

Parts = list[Substitution]
# Limit on the nesting of substitutions.
_DEEPEST = 50
_NAME = re.compile(r"[A-Za-z][\w-]*")
# By the surrounding quote: the pattern of plain text there, and in an unquoted argument.
_STRING = {quote: re.compile(rf"(?:\\.|[^$\\{quote}]|\\|\$(?!\())+", re.DOTALL) for quote in ("", "'", '"')}
_WORD = {
    "": re.compile(r"(?:\\[()$'\"\\]|\\|[^ '\"\\$()]|\$(?!\())+"),
    "'": re.compile(r"(?:\\[()$'\\]|\\|[^ '\\$()]|\$(?!\())+"),
    '"': re.compile(r"(?:\\[()$\"\\]|\\|[^ \"\\$()]|\$(?!\())+"),
}
_OF_ROS_1 = {"arg": "var", "find": "find-pkg-share", "optenv": "env"}


@dataclass(frozen=True)
class Form:
    """A substitution of launch files: the function that creates it, and its allowed numbers of arguments."""

    make: Callable[..., Substitution]
    least: int = 0
    most: int | None = 0


SUBSTITUTIONS: dict[str, Form] = {}
# Modules that register elements and substitutions. ROS finds such extensions by their entry points.
_EXTENSIONS = ("launch.frontend.elements", "launch_ros.frontend")


def load_extensions() -> None:
    """Register all elements and substitutions."""
    for extension in _EXTENSIONS:
        import_module(extension)


def parse_substitution(text: str) -> Parts:
    """Parse a string with `$(…)`. Raise a ValueError that shows the position of an error."""
    if "$(" in text:
        # A Python launch file does not load the extensions, but its parameter files may need them.
        load_extensions()
    if not text:
        return [TextSubstitution(text="")]
    reader = _Reader(text)
    parts = reader.template("")
    if reader.at < len(text):
        reader.fail("the end")
    return parts


def unescaped(text: str) -> str:
    r"""Replace escaped characters such as `\(` with the characters themselves."""
    return re.sub(r"\\(.)", r"\1", text)


class _Reader:
    """Parses a string from position `at`."""

    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0
        self._depth = 0

    def template(self, quote: str) -> Parts:
        """Parse text and substitutions up to the closing quote or the end."""
        return self._read_parts(_STRING[quote], quote)

    def fail(self, expected: str) -> NoReturn:
        """Raise a ValueError for the current position."""
        excerpt = self.text[self.at : self.at + 20]
        found_text = f"found {excerpt!r}" if excerpt else "the text ends"
        raise ValueError(f"{self.text!r}, character {self.at + 1}: expected {expected}, {found_text}")

    def _read_parts(self, pattern: re.Pattern[str], quote: str) -> Parts:
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
        while self._skip(" "):
            arguments.append(self._argument(quote))
        self._depth -= 1
        if not self._skip(")"):
            self.fail("')', or one space and an argument; put quotes around one with spaces")
        return _make_substitution(name[0], arguments, self.text[begin : self.at])

    def _argument(self, quote: str) -> Parts:
        opening = self.text[self.at : self.at + 1]
        if not quote and opening and opening in "'\"":
            self.at += 1
            parts = self.template(opening)
            if not self._skip(opening):
                self.fail(f"the quote {opening} that ends the argument")
            return parts
        parts = self._read_parts(_WORD[quote], quote)
        if not parts:
            self.fail("an argument; between two there is one space")
        return parts

    def _skip(self, character: str) -> bool:
        is_next = self.text.startswith(character, self.at)
        self.at += is_next
        return is_next


def _make_substitution(name: str, arguments: Sequence[Parts], text: str) -> Substitution:
    form = SUBSTITUTIONS.get(name)
    if form is None:
        names = [*SUBSTITUTIONS]
        hint = did_you_mean(name, names) or f". There are: {', '.join(sorted(names))}"
        if name in _OF_ROS_1:
            hint = f". In ROS 2 write $({_OF_ROS_1[name]} …)"
        raise ValueError(f"{text}: there is no substitution '{name}'{hint}")
    if len(arguments) < form.least or (form.most is not None and len(arguments) > form.most):
        max_text = "more" if form.most is None else form.most
        expected = form.least if form.least == form.most else f"{form.least} to {max_text}"
        raise ValueError(
            f"{text}: {name} has {len(arguments)} arguments, expected {expected}. Arguments with "
            "spaces stand in quotes"
        )
    return form.make(*arguments)
