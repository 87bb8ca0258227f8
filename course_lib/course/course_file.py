"""exercises/course.toml: weeks, points, deadlines, late policy and limits."""

import math
import re
import tomllib
from collections.abc import Callable, Collection, Mapping
from dataclasses import MISSING, dataclass, field, fields
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, Literal, get_args, get_origin, get_type_hints
from zoneinfo import ZoneInfo, available_timezones

from course_lib.course.exercise import normalise
from course_lib.course.material import exercises_dir
from course_lib.errors import CourseError, did_you_mean
from course_lib.third_party import NOT_UTF8, read_text

POINTS_PER_WEEK = 100
Counts = Literal["last", "best"]


@dataclass(frozen=True)
class LatePolicy:
    """The late policy: a deduction in percent of the mark per started day after a grace period.

    Args:
        percent_per_day: Deduction for each started day.
        grace_minutes: Minutes after the deadline in which a submission is not late.
        max_percent: Maximum deduction; 100 is the whole mark.
        accepted_days: The last started day on which a submission is accepted. A later one gets no
            points.
    """

    percent_per_day: float = 10.0
    grace_minutes: float = 0.0
    max_percent: float = 100.0
    accepted_days: float | None = None

    def __post_init__(self) -> None:
        for name in ("percent_per_day", "max_percent"):
            if getattr(self, name) > 100:
                raise CourseError(f"{name}: {getattr(self, name):g}, expected 0 to 100")
        if self.accepted_days is not None and self.accepted_days % 1:
            raise CourseError(
                f"accepted_days: {self.accepted_days:g}, expected a whole number of started days"
            )

    def is_accepted(self, days: int) -> bool:
        """Return whether a submission `days` days late is accepted; a started day counts."""
        return self.accepted_days is None or days <= self.accepted_days

    @property
    def last_day(self) -> int | None:
        """The last started day on which a late submission receives points, or None if there is none."""
        if self.accepted_days is not None:
            return int(self.accepted_days)
        if self.max_percent < 100 or not self.percent_per_day:
            return None
        return math.ceil(100 / self.percent_per_day) - 1

    def penalty_percent(self, days: int) -> float:
        """Return the deduction from a mark [%]."""
        return min(self.percent_per_day * days, self.max_percent) if self.is_accepted(days) else 100.0


@dataclass(frozen=True)
class Limits:
    """Limits of a submission during grading: time in [s], output in [kB], memory and files in [MB].

    Time is wall-clock time, without the time a submission waits for a processor on a busy machine.
    The memory is that of each process, and twice that of all processes of a submission together.
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
            raise CourseError(
                f"{none[0]}: 0, expected a number above 0, because with this limit nothing can run"
            )

    @property
    def memory_of_all_processes(self) -> float:
        """The limit on the memory of all processes of a submission together [MB].

        A node runs in a fork of the process that ran the cells, and what they share counts twice.
        So these two can never exceed this limit before one of them exceeds its own.
        """
        return 2 * self.memory_megabytes


@dataclass(frozen=True)
class WeekSettings:
    """A week: deadlines in the course's local time, and points by the task's short name.

    Args:
        title: The week's title.
        deadline: Deadline of all students without an extension.
        points: Points by task, 100 in total.
        bonus: Additional points by task.
        extensions: Later deadlines by student or group, in any spelling of an ID.
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
        for student, when in self.extensions.items():
            # The year or month is often wrong, which would make all work of this student late.
            if self.deadline is not None and when < self.deadline:
                raise CourseError(
                    f"extensions: {student}: {when.isoformat()} is before the week's deadline, "
                    f"expected a later time than {self.deadline.isoformat()}"
                )
        object.__setattr__(self, "extensions", {normalise(s): when for s, when in self.extensions.items()})


@dataclass(frozen=True)
class CourseFile:
    """The content of course.toml.

    Args:
        weeks: The weeks whose table is valid.
        groups: The students' IDs by the name of their group, for extensions.
        faults: The error in each invalid week's table, with file and line. The other weeks can be
            used.
    """

    title: str
    weeks: Mapping[str, WeekSettings]
    # None means the time zone of this machine.
    time_zone: ZoneInfo | None = None
    late: LatePolicy = LatePolicy()
    limits: Limits = Limits()
    # Which of several submissions is used.
    counts: Counts = "last"
    groups: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    faults: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        groups = {normalise(name): tuple(map(normalise, ids)) for name, ids in self.groups.items()}
        for name in groups:
            if name in (member for ids in groups.values() for member in ids):
                raise CourseError(f"groups: {name} is both the name of a group and the ID of a student")
        object.__setattr__(self, "groups", groups)
        names = (*self.weeks, *self.faults)
        if strange := [week for week in names if not re.fullmatch(r"week\d\d", week)]:
            raise CourseError(f"weeks: {strange[0]}, expected a name like week01")

    @property
    def zone(self) -> ZoneInfo:
        """The time zone of deadlines and of local times.

        Raises:
            CourseError: course.toml does not set it, and this machine does not report its own.
        """
        return self.time_zone or machine_zone()

    @property
    def zone_note(self) -> str:
        """A line on the time zone if course.toml does not set it, or ""."""
        if self.time_zone is not None:
            return ""
        return f"Local times are {self.zone.key}, this machine's zone: course.toml names no time_zone."

    def require_valid(self, *weeks: str) -> None:
        """Raise the error of an invalid week. Without weeks, check all weeks of the course.

        Raises:
            CourseError: One of the weeks is invalid.
        """
        for week, fault in self.faults.items():
            if week in (weeks or self.faults):
                raise CourseError(fault)

    def deadline(self, week: str, student: str) -> datetime | None:
        """Return a week's deadline for a student, in the course's time zone.

        A student's own extension has priority over those of groups, of which the latest counts.
        """
        self.require_valid(week)
        settings = self.weeks[week]
        own_groups = [name for name, ids in self.groups.items() if student in ids]
        of_groups = [settings.extensions[name] for name in own_groups if name in settings.extensions]
        local = settings.extensions.get(student) or max(of_groups, default=settings.deadline)
        return local and local.replace(tzinfo=self.zone)

    def unknown_extensions(self, week: str, students: Collection[str]) -> list[str]:
        """Return the names in a week's extensions that are neither groups nor among the students.

        Args:
            week: A valid week.
            students: IDs in normalised spelling.
        """
        known = {*self.groups, *(member for ids in self.groups.values() for member in ids), *students}
        return [name for name in self.weeks[week].extensions if name not in known]

    def closing_time(self, week: str) -> datetime:
        """Return the time after which no student receives points for a week.

        Raises:
            CourseError: The week has no deadline, or late submissions get points without end.
        """
        self.require_valid(week)
        if week not in self.weeks:
            raise CourseError(f"there is no {week} in course.toml{did_you_mean(week, self.weeks)}")
        settings, days = self.weeks[week], self.late.last_day
        if settings.deadline is None:
            raise CourseError(f"{week} has no deadline in course.toml, so it can always be handed in")
        if days is None:
            raise CourseError(
                f"{week} can always be handed in late: set accepted_days below [late] in course.toml"
            )
        last = max([settings.deadline, *settings.extensions.values()])
        # As in `count_days_late`, a day lasts until the same local time of the next day, even if
        # the clocks change in between.
        end = last.replace(tzinfo=self.zone) + timedelta(days=days)
        return end.astimezone(UTC) + timedelta(minutes=self.late.grace_minutes)


def find_zone(name: str) -> ZoneInfo:
    """Return a time zone by its name.

    Raises:
        CourseError: It does not exist. The message suggests the closest name.
    """
    if name not in available_timezones():
        suggestion = did_you_mean(name, available_timezones(), 3) or '. Write one like "Europe/Paris".'
        raise CourseError(f"there is no time zone {name!r}{suggestion}")
    return ZoneInfo(name)


def machine_zone() -> ZoneInfo:
    """Return the time zone of the operating system.

    Raises:
        CourseError: The machine does not report it.
    """
    from tzlocal import get_localzone

    try:
        zone = get_localzone()
        return zone if isinstance(zone, ZoneInfo) else ZoneInfo(str(zone))
    # tzlocal does not handle errors of zoneinfo, the Windows registry and configuration files.
    except Exception as error:
        raise CourseError(
            f"this machine does not report its time zone ({error}). Write one like "
            'time_zone = "Europe/Paris" into exercises/course.toml'
        ) from error


def read_course_file(path: Path) -> CourseFile:
    """Read and validate course.toml.

    An error in a week's table is stored as the fault of that week.

    Raises:
        CourseError: A key is missing, unknown or has an invalid value. The message contains file
            and line.
    """
    try:
        text = read_text(path)
        content = tomllib.loads(text)
        # The tables of invalid weeks are removed, so that the other weeks can be read.
        weeks: Any = content.get("weeks")
        errors = dict[str, _MisfitError]()
        for week in list(weeks) if isinstance(weeks, dict) else ():
            try:
                settings: WeekSettings = _read(WeekSettings, weeks[week], ("weeks", week))
                _reject_clock_changes(settings, week, content.get("time_zone"))
            except _MisfitError as misfit:
                errors[week] = misfit
                del weeks[week]
        faults = {week: _locate(path, text, error) for week, error in errors.items()}
        course: CourseFile = _read(CourseFile, content, faults=faults)
    except UnicodeDecodeError as error:
        raise CourseError(f"{path} can't be read: {NOT_UTF8}") from error
    except (OSError, ValueError, RecursionError) as error:
        raise CourseError(f"{path} can't be read: {error}") from error
    except _MisfitError as error:
        raise CourseError(_locate(path, text, error)) from error
    return course


def _reject_clock_changes(settings: WeekSettings, week: str, zone: object) -> None:
    """Raise the error of a deadline or extension that the clocks of the course's zone skip or repeat."""
    if not isinstance(zone, str) or zone not in available_timezones():
        return
    times = {("extensions", student): when for student, when in settings.extensions.items()}
    times |= {("deadline", ""): settings.deadline} if settings.deadline else {}
    for keys, when in times.items():
        # `fold` selects the offset from UTC before or after a change of the clocks.
        before, after = (when.replace(tzinfo=ZoneInfo(zone), fold=fold).timestamp() for fold in (0, 1))
        if before != after:
            happens = "does not exist" if before > after else "occurs twice"
            example = when.replace(hour=23, minute=59, second=0).isoformat()
            text = f"{when.isoformat()} {happens} in {zone}, because the clocks change. Write {example}"
            raise _MisfitError(("weeks", week, *filter(None, keys)), f"{text}, or another time of that day")


def shipped_course_file() -> CourseFile:
    """Read the course.toml of this installation."""
    return read_course_file(exercises_dir() / "course.toml")


# By annotation: the test of a value, the expected value in the error message, and the conversion.
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
    datetime: (
        lambda v: isinstance(v, datetime) and v.tzinfo is None,
        "local time, 2026-10-11T23:59:00",
        lambda v: v,
    ),
}
# Keys of earlier versions, and their replacements.
REMOVED: dict[tuple[str, ...], str] = {
    ("term",): "the learning platform adds up the term now. Delete this table and those below it, such as "
    "[term.weights], and set weights and dropped weeks in the platform's gradebook",
}
KINDS[datetime | None] = KINDS[datetime]
KINDS[float | None] = KINDS[float]
KINDS[ZoneInfo | None] = KINDS[ZoneInfo]


class _MisfitError(CourseError):
    """An invalid value in course.toml, with the keys that lead to it."""

    def __init__(self, keys: tuple[str, ...], text: str) -> None:
        super().__init__(": ".join((*keys, text)))
        self.keys = keys


def _locate(path: Path, text: str, error: _MisfitError) -> str:
    """Return an error's text with file and line.

    The line is that of the key or, if it is missing, of the innermost table that contains it.
    """
    table: tuple[str, ...] = ()
    # The best match so far: the number of its keys, and its line.
    best = (0, 0)
    for number, line in enumerate(text.splitlines(), 1):
        if heading := re.match(r"\s*\[([^\[\]]+)\]", line):
            table = place = tuple(part.strip() for part in heading[1].split("."))
        elif entry := re.match(r"\s*([\w.-]+)\s*=", line):
            place = (*table, *entry[1].split("."))
        else:
            continue
        if place == error.keys[: len(place)] and len(place) > best[0]:
            best = (len(place), number)
    return f"{path}{f' line {best[1]}' if best[1] else ''}: {error}"


def _read(kind: Any, value: Any, keys: tuple[str, ...] = (), **found: Any) -> Any:
    """Convert a TOML value to an annotated type.

    A table becomes a dataclass, with the values `found`.
    """
    if kind in KINDS:
        is_right, expected, make = KINDS[kind]
        if not is_right(value):
            actual = repr(value) if isinstance(value, str) else value
            raise _MisfitError(keys, f"{actual}, expected {expected}")
        return make(value)
    if not isinstance(value, dict):
        raise _MisfitError(keys, f"{value!r}, expected a table")
    if get_origin(kind) is Mapping:
        return {key: _read(get_args(kind)[1], item, (*keys, key)) for key, item in value.items()}
    hints = {key: hint for key, hint in get_type_hints(kind).items() if key not in found}
    if removed := next((key for key in value if (*keys, key) in REMOVED), ""):
        raise _MisfitError((*keys, removed), REMOVED[*keys, removed])
    if strange := sorted(value.keys() - hints.keys()):
        text = f"unknown key {strange[0]!r}, known: {', '.join(sorted(hints))}"
        raise _MisfitError((*keys, strange[0]), text)
    required_fields = {f.name for f in fields(kind) if f.default is MISSING and f.default_factory is MISSING}
    if missing := sorted(required_fields - value.keys()):
        raise _MisfitError(keys, f"the key {missing[0]!r} is missing")
    items = {key: _read(hints[key], item, (*keys, key)) for key, item in value.items()}
    try:
        return kind(**items, **found)
    except CourseError as error:
        raise _MisfitError(keys, str(error)) from error
