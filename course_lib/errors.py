"""The kit's exception, and phrases shared by many of its messages."""

import re
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from pathlib import Path

# A path of the usual file systems has at most 255 characters in each part, and rarely more in
# total.
_LONG_WORD = re.compile(r"(\S{80})\S{220,}(\S{20})")
# A quoted value with spaces, as repr() writes it: after a space or bracket, up to its next quote.
_LONG_QUOTE = re.compile(
    r"""(?<![^\s(\[{:=,])(['"])((?:(?!\1).){80})(?:(?!\1).){220,}((?:(?!\1).){20}\1)""", re.S
)


class CourseError(Exception):
    """An error that the user can fix.

    The message states the input, the expectation and the next step. Long words and quoted values in
    it are shortened.
    """

    # Exit code of the command that the error ends.
    exit_code = 2

    def __init__(self, *arguments: object) -> None:
        super().__init__(*(shorten_words(text) if isinstance(text, str) else text for text in arguments))

    def _render_traceback_(self) -> list[str]:
        """Return the lines that IPython prints instead of a traceback."""
        return [f"{type(self).__name__}: {self}"]


def shorten_words(text: str) -> str:
    """Shorten each word or quoted value of a message that is longer than any path or name."""
    return _LONG_WORD.sub(r"\1…\2", _LONG_QUOTE.sub(r"\1\2…\3", text))


def did_you_mean(name: str, there: Iterable[str], max_count: int = 1) -> str:
    """Return a suggestion of the closest names, which ends a sentence without a period, or ""."""
    close = get_close_matches(name, list(there), n=max_count, cutoff=0.5)
    return f". Did you mean {' or '.join(close)}?" if close else ""


def format_count(count: int, noun: str) -> str:
    """Return a number with its noun: "1 message", "2 messages"."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def location_of(path: Path, text: str) -> str:
    """Return "path line 12" for the first line of a file that contains a string, else the path."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return str(path)
    number = next((number for number, line in enumerate(lines, 1) if text in line), 0) if text else 0
    return f"{path} line {number}" if number else str(path)


def join_words(items: Sequence[str]) -> str:
    """Join strings as in an English sentence: "a, b and c"."""
    return " and ".join(filter(None, [", ".join(items[:-1]), *items[-1:]]))
