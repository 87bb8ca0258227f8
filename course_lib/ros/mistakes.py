"""Marks on exceptions, by which their hints are found."""

from enum import Enum, auto
from traceback import walk_tb
from typing import TypeVar

_MARK = "_mistake"  # attribute of an exception
ErrorT = TypeVar("ErrorT", bound=BaseException)


class Mistake(Enum):
    """The mistakes with which raising code marks its exceptions."""

    NO_CALLBACK = auto()
    TIMER_CALLBACK = auto()  # called with the wrong arguments, as is the next one
    SERVICE_CALLBACK = auto()
    PERIOD = auto()
    REQUEST = auto()
    RESPONSE = auto()
    GOAL = auto()
    UNNAMED_FIELD = auto()
    NO_STATUS = auto()
    STAMP = auto()


def marked(error: ErrorT, mistake: Mistake) -> ErrorT:
    """Mark an exception that is about to be raised."""
    vars(error)[_MARK] = mistake
    return error


def mark(error: BaseException, mistake: Mistake, *, depth: int = 1) -> None:
    """Mark a caught exception if it comes from no deeper than `depth` frames: from the caller's own line."""
    if len(list(walk_tb(error.__traceback__))) == depth:
        marked(error, mistake)


def mistake_of(error: BaseException) -> Mistake | None:
    """Return the mark of an exception, if it has one."""
    found = vars(error).get(_MARK)
    return found if isinstance(found, Mistake) else None
