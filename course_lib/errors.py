"""The kit's one exception, and phrases that many of its messages share."""

from collections.abc import Iterable
from difflib import get_close_matches


class CourseError(Exception):
    """An error that the user can fix; the message names the input, the expectation and the next step."""


def did_you_mean(name: str, there: Iterable[str], most: int = 1) -> str:
    """Return a suggestion of the nearest names, to append to a text without a full stop, or ""."""
    close = get_close_matches(name, list(there), n=most, cutoff=0.5)
    return f". Did you mean {' or '.join(close)}?" if close else ""


def counted(count: int, noun: str) -> str:
    """Return a number with its noun: "1 message", "2 messages"."""
    return f"{count} {noun}{'' if count == 1 else 's'}"
