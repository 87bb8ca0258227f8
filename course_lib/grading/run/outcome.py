"""Plain data from student code: returned values, errors and printed lines.

Everything that leaves the student's process is reduced to plain data of limited size before it is
sent, and checked again on arrival, because student code can send anything.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

import numpy as np

from course_lib.errors import CourseError
from course_lib.ros.hints import hint
from course_lib.ros.tracebacks import format_location, line_of_traceback

MAX_ITEMS = 200_000
MAX_DEPTH = 20
MAX_TEXT = 100_000  # limit on the characters of a string
MAX_INT = 2**63
# Replaces the returned value of a call that raised an exception.
RAISED = {"object": "nothing, as the call raised an exception"}


MAX_ERRORS = 20


# The part of an error message after the name of the object.
NOT_DEFINED = "is not defined: no code cell that ran without an error defines it"


@dataclass
class Outcome:
    """The returned values and errors of student code, and the CPU time [s] that its process reported."""

    returns: list[Any] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)
    cpu_seconds: float = 0.0


def plain(value: Any) -> Any:
    """Convert numbers, strings, arrays, messages and containers of them to plain Python values.

    Any other value, and a value that is too large, becomes `{"object": description}`, which no
    check expects.
    """
    return _plain(value, MAX_DEPTH, [MAX_ITEMS])


def is_plain(value: Any, depth: int = MAX_DEPTH + 3) -> bool:
    """Return whether a value from the worker has the form that `plain` returns."""
    if depth < 0:
        return False
    if type(value) is list:
        return len(value) <= MAX_ITEMS and all(is_plain(item, depth - 1) for item in value)
    if type(value) is dict:
        items = value.items()
        return all(type(key) is str and is_plain(item, depth - 1) for key, item in items)
    if type(value) is str:
        return len(value) <= MAX_TEXT
    return value is None or type(value) in (bool, int, float)


def _plain(value: Any, depth: int, room: list[int]) -> Any:
    room[0] -= 1
    if depth < 0 or room[0] < 0:
        return {"object": "a value too deep or too large"}
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or type(value) in (bool, float):
        return value
    if type(value) is int:
        return value if abs(value) < MAX_INT else {"object": "an integer of more than 63 bits"}
    if isinstance(value, str):
        return str(value)[:MAX_TEXT].encode("utf-8", "replace").decode()
    if isinstance(value, np.ndarray):
        value = value.tolist() if value.size <= room[0] else None
        return _plain(value, depth, room) if value is not None else {"object": "an array too large"}
    if isinstance(value, (list, tuple)):
        return [_plain(item, depth - 1, room) for item in islice(value, max(room[0], 0))]
    if isinstance(value, dict):
        return {str(key): _plain(item, depth - 1, room) for key, item in value.items()}
    from course_lib.ros.messages import RosMessage, to_plain

    if isinstance(value, RosMessage):
        return _plain(to_plain(value), depth - 1, room)
    return {"object": f"a {type(value).__name__}"}


MAX_LENGTH = 500  # limit on the characters of an error


def describe(error: BaseException) -> str:
    """Return the exception's type and text, its location, and the hint for a common mistake.

    For example "ZeroDivisionError: division by zero (cell In[3], line 2: 1 / 0)".
    """
    where = (
        format_location(error.filename or "", error.lineno)
        if isinstance(error, SyntaxError) and error.lineno
        else line_of_traceback(error.__traceback__)
    )
    kind = type(error).__name__
    try:
        what = error.msg if isinstance(error, SyntaxError) else str(error)
    except (Exception, SystemExit):
        # __str__ may be student code and raise any exception.
        what = "(its __str__ failed)"
    if not isinstance(error, CourseError):
        what = f"{kind}: {what}" if what else kind
    # ROS's errors about lists of numbers contain the limits of float64, with 309 digits.
    what = re.sub(r"\d{40,}\.\d+", lambda found: f"{float(found[0]):.6g}", what)[:MAX_LENGTH]
    place, is_raise, _ = where.partition(": raise ")
    # The source of a raise statement adds nothing to the exception's text.
    if is_raise:
        where = place
    found = hint(error)
    text = f"{what}{where and f' ({where})'}{found and f'; hint: {found}'}"
    return text.encode("utf-8", "replace").decode()  # Lone surrogates cannot be encoded.


MAX_LINES = 20
MAX_LINE = 200  # limit on the characters of a line
_STAMP = re.compile(r"\[\d+\.\d{9}\] ")  # log stamps, which make equal lines differ


def printed_lines(outputs: Iterable[str]) -> tuple[str, ...]:
    """Return the lines of the first output that is not empty, shortened for display."""
    text = next((output for output in outputs if output.strip()), "")
    lines = collapse_lines(text.rstrip().splitlines())
    kept_lines = [line if len(line) <= MAX_LINE else f"{line[:MAX_LINE]} …" for line in lines[:MAX_LINES]]
    more = len(lines) - len(kept_lines)
    return (*kept_lines, f"… {more} more lines") if more > 0 else tuple(kept_lines)


def collapse_lines(lines: Iterable[str]) -> list[str]:
    """Collapse repeated lines into a count, ignoring log stamps in the comparison."""
    collapsed: list[str] = []
    last, repeated = None, 0
    for line in [*lines, None]:
        plain = None if line is None else _STAMP.sub("", line)
        if plain is not None and plain == last:
            repeated += 1
            continue
        if repeated:
            collapsed.append(f"… repeated {repeated} times" if repeated > 1 else collapsed[-1])
        last, repeated = plain, 0
        if line is not None:
            collapsed.append(line)
    return collapsed


def still_running_message(seconds: float, line: str = "") -> str:
    """Return the error message about code that does not end; `line` is its last known location."""
    where = line and f" ({line})"
    return f"still running after {seconds:.3g} s{where}: is it an endless loop? It was stopped."
