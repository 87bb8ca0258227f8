"""The sender of a file in a platform's download, by the names that Moodle, Canvas and nbgrader give."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from course_lib.course.identity import normalise

NBGRADERS = ("submitted", "inbound")  # nbgrader's folders around those of the students
# In the exchange's inbound/ a student has a folder for each attempt: STUDENT+ASSIGNMENT+TIME+SECRET.
INBOUND = re.compile(r"(?P<student>[^+]+)\+[^+]+\+(?P<time>\d{4}-\d\d-\d\d \d\d:\d\d:\d\d[^+/]*)(\+[^+]*)?")
Platform = Literal["moodle", "anonymous", "canvas"]
PATTERNS: dict[Platform, re.Pattern[str]] = {
    "moodle": re.compile(r"(?P<name>.+)_(?P<number>\d+)_assignsubmission_file_?(?P<file>.*)"),
    "anonymous": re.compile(
        r"(?P<late>LATE_)?(?P<name>anon_(?P<number>[^\W_]+))_(?P<attachment>\d+)_(?P<file>.+)"
    ),
    "canvas": re.compile(r"(?P<name>.+?)_(?P<late>LATE_)?(?P<number>\d+)_(?P<attachment>\d+)_(?P<file>.+)"),
}
DEFAULT_IDS = {"moodle": "participant{}", "anonymous": "anon_{}", "canvas": "{}"}


@dataclass(frozen=True)
class PlatformName:
    """The parts of a platform's name of a file.

    Args:
        platform: Which pattern it follows; "anonymous" is Canvas's with the students hidden.
        name: The student's name.
        number: The platform's number of the student, or the anonymous ID.
        attachment: Canvas's number of the file.
        late: Canvas's word; None where the platform does not say.
        file: The file's name as the student gave it; "" where a folder has the platform's name.
    """

    platform: Platform
    name: str
    number: str
    attachment: str
    late: bool | None
    file: str

    @property
    def default_id(self) -> str:
        """The student's ID where no roster has one: the number as the platform's own CSV has it."""
        return normalise(DEFAULT_IDS[self.platform].format(self.number))


@dataclass(frozen=True)
class Sender:
    """The student who sent a file, the path it goes to, and the platform's name of it, if it has one."""

    student: str
    path: Path
    named: PlatformName | None = None


def platform_name(part: str) -> PlatformName | None:
    """Read one part of a path as a platform's name."""
    for platform, pattern in PATTERNS.items():
        if match := pattern.fullmatch(part):
            known = match.groupdict()
            late = None if platform == "moodle" else bool(known["late"])
            attachment = known.get("attachment") or ""
            return PlatformName(platform, known["name"], known["number"], attachment, late, known["file"])
    return None


def sender_of(path: tuple[str, ...], ids: Mapping[str, str]) -> Sender:
    """Return who handed a file in, by the outermost part of its path that says so.

    Args:
        path: The parts of its path, archives included.
        ids: The students' IDs by the platform's numbers.

    Raises:
        CourseError: A folder that would name the student is not an ID.
    """
    parts = path[1:] if path[0] in NBGRADERS and len(path) > 1 else path
    for place, part in enumerate(parts):
        is_last = place == len(parts) - 1
        if named := platform_name(part):
            student = ids.get(named.number) or named.default_id
            below = _folders(parts[place + 1 :]) or [named.file or part]
            return Sender(student, Path(student, *below), named)
        if not is_last and (attempt := INBOUND.fullmatch(part)):
            student = normalise(attempt["student"])
            when = re.sub(r"\W", "", attempt["time"])  # each attempt has a time stamp of its own beside it
            return Sender(student, Path(student, when, *_folders(parts[place + 1 :])))
        if not is_last and not _is_zip(part):
            student = normalise(part)
            return Sender(student, Path(student, *_folders(parts[place + 1 :])))
    return Sender(parts[-1], Path(parts[-1]))  # the file says who


def _folders(parts: tuple[str, ...]) -> list[str]:
    """Return a path without the archives in it: a notebook names its files by their folders."""
    return [*(part for part in parts[:-1] if not _is_zip(part)), *parts[-1:]]


def _is_zip(part: str) -> bool:
    return part.lower().endswith(".zip")
