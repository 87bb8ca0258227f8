"""Requests of the page, in which anything may be."""

import getpass
from dataclasses import dataclass
from typing import Any

from course_lib.errors import CourseError
from course_lib.foreign import read_json
from course_lib.grading.marks.marks import Given
from course_lib.grading.reports.table import tame

MAX_NAME = 80  # characters
MAX_COMMENT = 10_000  # characters
MAX_MARKS = 50  # of one save


@dataclass(frozen=True)
class Save:
    """The marks of one person for one task, and the revision that the person has seen."""

    by: str
    revision: str
    given: tuple[Given, ...]


def read_save(body: bytes) -> Save:
    """Read what the page sends.

    Raises:
        CourseError: It is not of this form; names what was expected.
    """
    try:
        content = read_json(body)
    except ValueError as error:
        raise CourseError("the page sent no JSON: load it again") from error
    match content:
        case {"by": str(by), "revision": str(revision), "marks": [_, *_] as marks} if len(marks) <= MAX_MARKS:
            return Save(read_name(by), revision, tuple(map(_given, marks)))
    raise CourseError('the page sent no marks: expected {"by": …, "revision": …, "marks": [one or more]}')


def _given(content: Any) -> Given:
    match content:
        case {"row": str(row), "points": None | int() | float() as points, "comment": str(comment)}:
            if len(comment) > MAX_COMMENT:
                raise CourseError(
                    f"the comment has {len(comment)} characters, expected {MAX_COMMENT} at most"
                )
            if not isinstance(points, bool):
                return Given(points, row, _clean(comment).strip())
    raise CourseError(f"the page sent {content!r:.80}: expected row, points and comment")


def read_name(text: str) -> str:
    """Return a person's name in one line; without one, that of the machine's user."""
    return " ".join(_clean(text).split())[:MAX_NAME] or getpass.getuser()


def read_number(text: str) -> int:
    """Read the number of a change.

    Raises:
        CourseError: It is none.
    """
    if not text.isdecimal() or len(text) > 12:
        raise CourseError(f"{text!r:.40} is not the number of a change")
    return int(text)


def _clean(text: str) -> str:
    return str(tame(text.encode("utf-8", "replace").decode()))
