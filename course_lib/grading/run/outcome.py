"""Plain data from student code: returned values, errors, printed lines and usage."""

import io
import json
import os
import re
import sys
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from itertools import islice
from typing import Any

import numpy as np

from course_lib.errors import CourseError
from course_lib.ros.hints import hint
from course_lib.ros.tracebacks import line_of_traceback, name_line

MAX_ITEMS = 200_000
MAX_DEPTH = 20
MAX_TEXT = 100_000  # characters
MAX_INT = 2**63
RAISED = {"object": "nothing, as the call raised an exception"}  # in place of a returned value


MAX_ERRORS = 20


NOT_MADE = "is not in the notebook: no cell that ran to its end makes it"  # behind a task's name


@dataclass
class Outcome:
    """Returned values and errors of student code, and the CPU that it says it used [s]."""

    returns: list[Any] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)
    cpu_seconds: float = 0.0


def plain(value: Any) -> Any:
    """Turn numbers, texts, arrays, messages and containers of them into plain Python values.

    What is none of these, or too large, becomes `{"object": what it is}`, which no check expects.
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
    return _message(value, depth, room)


def _message(value: Any, depth: int, room: list[int]) -> Any:
    from course_lib.ros.messages import RosMessage, to_plain

    if isinstance(value, RosMessage):
        return _plain(to_plain(value), depth - 1, room)
    return {"object": f"a {type(value).__name__}"}


MAX_LENGTH = 500  # characters


def describe(error: BaseException) -> str:
    """Return what was raised, where, and the hint for a common mistake.

    For example "ZeroDivisionError: division by zero (cell In[3], line 2: 1 / 0)".
    """
    where = _place(error)
    what = _what(error)[:MAX_LENGTH]
    place, is_raise, _ = where.partition(": raise ")
    if is_raise:  # that line says nothing that the text does not say
        where = place
    found = hint(error)
    said = f"{what}{where and f' ({where})'}{found and f'; hint: {found}'}"
    return said.encode("utf-8", "replace").decode()  # half of a surrogate pair can't leave the process


def _what(error: BaseException) -> str:
    try:
        text = error.msg if isinstance(error, SyntaxError) else str(error)
    except (Exception, SystemExit):  # str() is the student's own code here, and may raise anything
        text = "(its text can't be made)"
    if isinstance(error, CourseError):
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def _place(error: BaseException) -> str:
    if isinstance(error, SyntaxError) and error.lineno:
        return name_line(error.filename or "", error.lineno)
    return line_of_traceback(error.__traceback__)


MAX_LINES = 20
MAX_LINE = 200  # characters
MAX_PRINTED = 1_000_000  # characters that are kept of a run in this process
_STAMP = re.compile(r"\[\d+\.\d{9}\] ")  # of a log line: it makes equal lines differ


class Bounded(io.StringIO):
    """A text that keeps MAX_PRINTED characters, so that an endless loop does not fill the memory."""

    def write(self, text: str) -> int:
        """Keep what there is room for."""
        super().write(text[: max(0, MAX_PRINTED - self.tell())])
        return len(text)


def printed(outputs: Iterable[str]) -> tuple[str, ...]:
    """Return the lines of the first output that is not empty, as a person wants to see them."""
    text = next((one for one in outputs if one.strip()), "")
    lines = collapsed(text.rstrip().splitlines())
    shown = [line if len(line) <= MAX_LINE else f"{line[:MAX_LINE]} …" for line in lines[:MAX_LINES]]
    more = len(lines) - len(shown)
    return (*shown, f"… {more} more lines") if more > 0 else tuple(shown)


def collapsed(lines: Iterable[str]) -> list[str]:
    """Return lines of which those that follow an equal one are counted; times of logs do not matter."""
    made: list[str] = []
    last, repeated = None, 0
    for line in [*lines, None]:
        plain = None if line is None else _STAMP.sub("", line)
        if plain is not None and plain == last:
            repeated += 1
            continue
        if repeated:
            made.append(f"… repeated {repeated} times" if repeated > 1 else made[-1])
        last, repeated = plain, 0
        if line is not None:
            made.append(line)
    return made


_RSS_PER_MB = 1e6 if sys.platform == "darwin" else 1e3  # getrusage counts bytes there, kB elsewhere


@dataclass(frozen=True)
class Usage:
    """CPU of all processes together [s], and the most memory that one of them held [MB].

    Where files are on a disk, also the most that they took [MB]; else the kernel bounds them. `scenarios` has
    the CPU of each scenario [s] by task and name, as the worker, which runs the student's code, tells it.
    """

    cpu_seconds: float = 0.0
    memory_megabytes: float = 0.0
    files_megabytes: float = 0.0
    scenarios: Mapping[str, float] = field(default_factory=dict)

    def __add__(self, other: "Usage") -> "Usage":
        memory = max(self.memory_megabytes, other.memory_megabytes)
        files = max(self.files_megabytes, other.files_megabytes)
        cpu = round(self.cpu_seconds + other.cpu_seconds, 3)
        return Usage(cpu, memory, files, {**self.scenarios, **other.scenarios})

    def fills(self, megabytes: float) -> bool:
        """Return whether all files take far more than the limit of a single one."""
        return self.files_megabytes > 2 * megabytes

    def as_json(self) -> str:
        """Write it as a file, or into a message."""
        return json.dumps(asdict(self))


def wait_any_child() -> Usage:
    """Wait for any child to end, and return what it and those that it waited for have used.

    Raises:
        ChildProcessError: There is none.
    """
    _, _, used = os.wait3(0)
    return Usage(round(used.ru_utime + used.ru_stime, 3), round(used.ru_maxrss / _RSS_PER_MB, 1))


def still_running(seconds: float, line: str = "") -> str:
    """Return the message about code that does not come to an end; `line` is where it was, if known."""
    where = line and f" ({line})"
    return f"still running after {seconds:.3g} s{where}: an endless loop? It was stopped."
