"""Requests of students to look at a mark again, as files, with the answers."""

import getpass
import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from course_lib.course.state import write_whole
from course_lib.errors import CourseError
from course_lib.grading.marks.marks import read_entries

MAX_TEXT = 5000  # characters


@dataclass(frozen=True)
class RegradeRequest:
    """One request, and its answer when there is one.

    Args:
        text: Of the student.
        at: When it was entered.
        answer: Of a person, or "".
        by: That person.
        answered: When.
    """

    text: str
    at: str
    answer: str = ""
    by: str = ""
    answered: str = ""


def requests_path(out: Path, student: str, exercise: str) -> Path:
    """Return the file of a student's requests about an exercise."""
    return out / "requests" / student / f"{exercise}.json"


def read_requests(path: Path) -> tuple[RegradeRequest, ...]:
    """Return all requests of a file, the oldest first; raises a CourseError where it is damaged."""
    return tuple(read_entries(path, RegradeRequest))


def add_request(path: Path, text: str) -> None:
    """Append a request.

    Raises:
        CourseError: The text is empty or too long, or the last request waits for its answer.
    """
    there = read_requests(path)
    if not 0 < len(text.strip()) <= MAX_TEXT:
        raise CourseError(f"a request has 1 to {MAX_TEXT} characters, this one has {len(text.strip())}")
    if there and not there[-1].answer:
        raise CourseError("the last request about this exercise has no answer yet: answer it first")
    _write(path, (*there, RegradeRequest(text.strip(), _now())))


def add_answer(path: Path, answer: str) -> None:
    """Answer the last request.

    Raises:
        CourseError: There is none without an answer, or the answer is empty or too long.
    """
    there = read_requests(path)
    if not there or there[-1].answer:
        raise CourseError("there is no request about this exercise that waits for an answer")
    if not 0 < len(answer.strip()) <= MAX_TEXT:
        raise CourseError(f"an answer has 1 to {MAX_TEXT} characters, this one has {len(answer.strip())}")
    last = replace(there[-1], answer=answer.strip(), by=getpass.getuser(), answered=_now())
    _write(path, (*there[:-1], last))


def open_requests(out: Path) -> Iterator[tuple[str, str, RegradeRequest]]:
    """Yield student, exercise and request of all that wait for an answer."""
    for path in sorted((out / "requests").glob("*/*.json")):
        for one in read_requests(path)[-1:]:
            if not one.answer:
                yield path.parent.name, path.stem, one


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")


def _write(path: Path, requests: tuple[RegradeRequest, ...]) -> None:
    write_whole(path, json.dumps([asdict(one) for one in requests], indent=1, ensure_ascii=False).encode())
