"""Marks on exceptions, which select their hints."""

from enum import Enum, auto
from traceback import walk_tb
from typing import TypeVar

# The attribute of an exception that stores the mark.
_MARK = "_mistake"
ErrorT = TypeVar("ErrorT", bound=BaseException)


class Mistake(Enum):
    """The mistakes with which exceptions are marked."""

    NO_CALLBACK = auto()
    TIMER_CALLBACK = auto()  # the callback does not accept its arguments
    SERVICE_CALLBACK = auto()
    PERIOD = auto()
    REQUEST = auto()
    RESPONSE = auto()
    GOAL = auto()
    FEEDBACK = auto()
    UNNAMED_FIELD = auto()
    NO_STATUS = auto()
    STAMP = auto()
    TWO_TYPES = auto()
    TWO_SPINNERS = auto()
    SHUT_DOWN = auto()
    ONLY_DESTROYED = auto()  # by itself and not by the node, which still lists it


def marked(error: ErrorT, mistake: Mistake) -> ErrorT:
    """Mark an exception that is about to be raised, and return it."""
    vars(error)[_MARK] = mistake
    return error


def mark(error: BaseException, mistake: Mistake, *, depth: int = 1) -> None:
    """Mark a caught exception if it was raised at most `depth` frames deep, in the caller's own line."""
    if len(list(walk_tb(error.__traceback__))) == depth:
        marked(error, mistake)


def mistake_of(error: BaseException) -> Mistake | None:
    """Return the mistake with which an exception is marked, or None."""
    mark = vars(error).get(_MARK)
    return mark if isinstance(mark, Mistake) else None
