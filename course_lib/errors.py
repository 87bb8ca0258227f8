"""The one exception base of the kit, and words that many of its messages share."""

from collections.abc import Iterable
from difflib import get_close_matches


class CourseError(Exception):
    """Something a user can mend: the message names what came in, what was expected and what to do next."""


def did_you_mean(name: str, there: Iterable[str], most: int = 1) -> str:
    """Go on, behind a text without a full stop, with the nearest names; "" where none is near."""
    close = get_close_matches(name, list(there), n=most, cutoff=0.5)
    return f". Did you mean {' or '.join(close)}?" if close else ""


def counted(count: int, noun: str) -> str:
    """Say how many there are: "1 message", "2 messages"."""
    return f"{count} {noun}{'' if count == 1 else 's'}"
