"""exercises/course.toml: weeks, points, deadlines, late policy, limits."""

import math
import re
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, field, fields
from datetime import datetime
from pathlib import Path
from typing import Any, Literal, get_args, get_origin, get_type_hints
from zoneinfo import ZoneInfo, available_timezones

from course_lib.course.identity import normalise
from course_lib.course.installation import exercises_dir
from course_lib.errors import CourseError, did_you_mean

POINTS_PER_WEEK = 100
Counts = Literal["last", "best"]


@dataclass(frozen=True)
class Late:
    """The late policy: percent of the mark per started day, after some minutes of grace."""

    percent_per_day: float = 10.0
    grace_minutes: float = 0.0


@dataclass(frozen=True)
class Limits:
    """Limits of a submission at grading: time in [s], output in [kB], memory and files in [MB].

    The time is that of the wall clock, without what a submission waits for a processor on a busy machine.
    """

    cell_seconds: float = 10.0
    scenario_seconds: float = 10.0
    total_seconds: float = 60.0
    output_kilobytes: float = 1000.0
    memory_megabytes: float = 2000.0
    scratch_megabytes: float = 64.0
    processes: float = 64.0

    def __post_init__(self) -> None:
        if none := [name for name, limit in vars(self).items() if not limit]:
            raise CourseError(f"{none[0]}: 0, expected a number above 0, as nothing could run")


@dataclass(frozen=True)
class WeekSettings:
    """One week: deadlines in the course's local time, points by the task's short name.

    Args:
        title: Its name.
        deadline: Of all students.
        points: By task; they sum to 100.
        bonus: By task, on top.
        extensions: Later deadlines, by student; any spelling of an ID.
    """

    title: str
    deadline: datetime | None = None
    points: Mapping[str, float] = field(default_factory=dict)
    bonus: Mapping[str, float] = field(default_factory=dict)
    extensions: Mapping[str, datetime] = field(default_factory=dict)

    def __post_init__(self) -> None:
        total = sum(self.points.values())
        if self.points and not math.isclose(total, POINTS_PER_WEEK):
            raise CourseError(f"points: they sum to {total:g}, expected {POINTS_PER_WEEK}")
        if twice := sorted(self.points.keys() & self.bonus.keys()):
            raise CourseError(f"bonus: {', '.join(twice)} is in points and in bonus")
        object.__setattr__(self, "extensions", {normalise(s): when for s, when in self.extensions.items()})


@dataclass(frozen=True)
class Term:
    """The way from the marks of weeks to a total.

    Args:
        weights: Of weeks; 1 for each that is not named.
        drop_lowest: The number of lowest weeks of each student that do not count.
        group_weeks: In these the hand-in of one student counts for the whole group.
        quiz_percent: The share of the quizzes in the total.
    """

    weights: Mapping[str, float] = field(default_factory=dict)
    drop_lowest: float = 0.0
    group_weeks: tuple[str, ...] = ()
    quiz_percent: float = 0.0

    def __post_init__(self) -> None:
        if self.drop_lowest % 1:
            raise CourseError(f"drop_lowest: {self.drop_lowest:g}, expected a whole number of weeks")
        if self.quiz_percent > 100:
            raise CourseError(f"quiz_percent: {self.quiz_percent:g}, expected 0 to 100")


@dataclass(frozen=True)
class CourseFile:
    """All of course.toml.

    Args:
        weeks: Those whose part is right.
        faults: By week, what is wrong with its part, with file and line; the other weeks can be used.
    """

    title: str
    weeks: Mapping[str, WeekSettings]
    time_zone: ZoneInfo | None = None  # the machine's
    late: Late = Late()
    limits: Limits = Limits()
    counts: Counts = "last"  # of several submissions
    term: Term = Term()
    faults: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for week in (*self.term.weights, *self.term.group_weeks):
            if week not in self.faults and not (week in self.weeks and self.weeks[week].points):
                raise CourseError(f"term: {week!r} is not a week with points")
        known = (*self.weeks, *self.faults)
        if strange := [week for week in known if not re.fullmatch(r"week\d\d", week)]:
            raise CourseError(f"weeks: {strange[0]}, expected a name like week01")

    @property
    def zone(self) -> ZoneInfo:
        """The zone of deadlines and of local times.

        Raises:
            CourseError: course.toml names none, and this machine does not report its own.
        """
        return self.time_zone or machine_zone()

    @property
    def zone_note(self) -> str:
        """A line on the zone where nobody has chosen it, or ""."""
        if self.time_zone is not None:
            return ""
        return f"Local times are {self.zone.key}, this machine's zone: course.toml names no time_zone."

    def demand(self, *weeks: str) -> None:
        """Refuse what needs weeks of which one has a fault; by default all of the course.

        Raises:
            CourseError: The first fault.
        """
        for week, fault in self.faults.items():
            if week in (weeks or self.faults):
                raise CourseError(fault)

    def deadline(self, week: str, student: str) -> datetime | None:
        """Return a week's deadline for one student, with the course's time zone."""
        self.demand(week)
        local = self.weeks[week].extensions.get(student, self.weeks[week].deadline)
        return local and local.replace(tzinfo=self.zone)


def zone_named(name: str) -> ZoneInfo:
    """Return a zone.

    Raises:
        CourseError: There is none of this name; the message has the nearest.
    """
    if name not in available_timezones():
        meant = did_you_mean(name, available_timezones(), 3) or '. Write one like "Europe/Paris".'
        raise CourseError(f"there is no time zone {name!r}{meant}")
    return ZoneInfo(name)


def machine_zone() -> ZoneInfo:
    """Return the zone that the operating system is set to.

    Raises:
        CourseError: The machine does not report it.
    """
    from tzlocal import get_localzone

    try:
        zone = get_localzone()
        return zone if isinstance(zone, ZoneInfo) else ZoneInfo(str(zone))
    except Exception as error:  # tzlocal raises what zoneinfo, the registry or a file of settings does
        raise CourseError(
            f'this machine does not tell its time zone ({error}). Write one like time_zone = "Europe/Paris" '
            "into exercises/course.toml"
        ) from error


def read_course_file(path: Path) -> CourseFile:
    """Read and check course.toml; what is wrong with the part of one week is kept as its fault.

    Raises:
        CourseError: Naming the file, the line and the key that is missing, unknown or of a wrong kind.
    """
    try:
        text = path.read_text(encoding="utf-8")
        content = tomllib.loads(text)
        found = _faulty_weeks(content)
        faults = {week: _named(path, text, error) for week, error in found.items()}
        course: CourseFile = _read(CourseFile, content, faults=faults)
    except (OSError, ValueError, RecursionError) as error:
        raise CourseError(f"{path} can't be read: {error}") from error
    except _MisfitError as error:
        raise CourseError(_named(path, text, error)) from error
    return course


def _faulty_weeks(content: Mapping[str, Any]) -> dict[str, "_MisfitError"]:
    """Return what is wrong with the part of each week, and take these parts out of the content."""
    weeks: Any = content.get("weeks")
    found = dict[str, _MisfitError]()
    for week in list(weeks) if isinstance(weeks, dict) else ():
        try:
            _read(WeekSettings, weeks[week], ("weeks", week))
        except _MisfitError as error:
            found[week] = error
            del weeks[week]
    return found


def shipped_course_file() -> CourseFile:
    """Read the course.toml of this installation."""
    return read_course_file(exercises_dir() / "course.toml")


def _is_local(value: Any) -> bool:
    return isinstance(value, datetime) and value.tzinfo is None


# By the annotation of a field: whether a value is right, what would be, and what is made of it.
KINDS: dict[Any, tuple[Callable[[Any], bool], str, Callable[[Any], Any]]] = {
    str: (lambda v: isinstance(v, str) and v != "", "a text", str),
    float: (lambda v: type(v) in (int, float) and 0 <= v < math.inf, "a number of at least 0", float),
    ZoneInfo: (lambda v: str(v) in available_timezones(), 'a name such as "Europe/Paris"', ZoneInfo),
    Counts: (lambda v: v in get_args(Counts), '"last" or "best"', str),
    tuple[str, ...]: (
        lambda v: isinstance(v, list) and all(isinstance(item, str) for item in v),
        "a list of texts",
        tuple,
    ),
    datetime: (_is_local, "local time, 2026-10-11T23:59:00", lambda v: v),
}
KINDS[datetime | None] = KINDS[datetime]
KINDS[ZoneInfo | None] = KINDS[ZoneInfo]


class _MisfitError(CourseError):
    """A value of course.toml that does not fit, with the keys that lead to it."""

    def __init__(self, keys: tuple[str, ...], text: str) -> None:
        super().__init__(": ".join((*keys, text)))
        self.keys = keys


def _named(path: Path, text: str, error: _MisfitError) -> str:
    """Return a misfit with its file and line."""
    line = _line_of(text, error.keys)
    return f"{path}{f' line {line}' if line else ''}: {error}"


def _line_of(text: str, keys: tuple[str, ...]) -> int:
    """Return the line of the key, or of the innermost table on the way to it that has one; else 0."""
    table: tuple[str, ...] = ()
    best = (0, 0)  # how many keys fit, and the line
    for number, line in enumerate(text.splitlines(), 1):
        if heading := re.match(r"\s*\[([^\[\]]+)\]", line):
            table = place = tuple(part.strip() for part in heading[1].split("."))
        elif entry := re.match(r"\s*([\w.-]+)\s*=", line):
            place = (*table, *entry[1].split("."))
        else:
            continue
        if place == keys[: len(place)] and len(place) > best[0]:
            best = (len(place), number)
    return best[1]


def _read(kind: Any, value: Any, keys: tuple[str, ...] = (), **found: Any) -> Any:
    """Convert a value of TOML to the type of an annotation; a table, with what is `found`, the dataclass."""
    if kind in KINDS:
        is_right, expected, make = KINDS[kind]
        if not is_right(value):
            came = repr(value) if isinstance(value, str) else value
            raise _MisfitError(keys, f"{came}, expected {expected}")
        return make(value)
    if not isinstance(value, dict):
        raise _MisfitError(keys, f"{value!r}, expected a table")
    if get_origin(kind) is Mapping:
        return {key: _read(get_args(kind)[1], item, (*keys, key)) for key, item in value.items()}
    hints = {key: hint for key, hint in get_type_hints(kind).items() if key not in found}
    if strange := sorted(value.keys() - hints.keys()):
        text = f"unknown key {strange[0]!r}, known: {', '.join(sorted(hints))}"
        raise _MisfitError((*keys, strange[0]), text)
    needed = {f.name for f in fields(kind) if f.default is MISSING and f.default_factory is MISSING}
    if missing := sorted(needed - value.keys()):
        raise _MisfitError(keys, f"the key {missing[0]!r} is missing")
    items = {key: _read(hints[key], item, (*keys, key)) for key, item in value.items()}
    try:
        return kind(**items, **found)
    except CourseError as error:
        raise _MisfitError(keys, str(error)) from error
