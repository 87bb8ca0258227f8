"""exercises/course.toml: weeks, points, deadlines, late policy, limits."""

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from datetime import datetime
from pathlib import Path
from typing import Any, TypeVar
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from course_lib.errors import CourseError

POINTS_PER_WEEK = 100


@dataclass(frozen=True)
class Late:
    """The late policy: percent of the mark per started day, after some minutes of grace."""

    percent_per_day: float = 10.0
    grace_minutes: float = 0.0


@dataclass(frozen=True)
class Limits:
    """What a submission may use at grading: wall clock in [s], output in [kB]."""

    cell_seconds: float = 20.0
    scenario_seconds: float = 20.0
    total_seconds: float = 120.0
    output_kilobytes: float = 1000.0


@dataclass(frozen=True)
class Week:
    """One week: deadline in the course's time zone, points by the task's short name."""

    title: str
    deadline: datetime | None = None
    points: Mapping[str, float] = field(default_factory=dict)
    bonus: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class CourseFile:
    """All of course.toml."""

    title: str
    time_zone: ZoneInfo
    weeks: Mapping[str, Week]
    late: Late = Late()
    limits: Limits = Limits()


def read_course_file(path: Path) -> CourseFile:
    """Read and check course.toml.

    Raises:
        CourseError: Naming the file and the key that is missing, unknown or of a wrong kind.
    """
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise CourseError(f"{path} can't be read: {error}") from error
    try:
        _known(table, "", {"title", "time_zone", "weeks", "late", "limits"})
        zone = ZoneInfo(_text(table, "", "time_zone"))
        weeks = {name: _week(name, week, zone) for name, week in _table(table, "", "weeks").items()}
        late, limits = _numbers(Late, table, "late"), _numbers(Limits, table, "limits")
        return CourseFile(_text(table, "", "title"), zone, weeks, late, limits)
    except (ZoneInfoNotFoundError, ValueError) as error:
        raise CourseError(f'{path}: time_zone: {error}, expected a name such as "Europe/Paris"') from error
    except CourseError as error:
        raise CourseError(f"{path}: {error}") from error


def _week(name: str, table: Any, zone: ZoneInfo) -> Week:
    where = f"weeks.{name}"
    if not isinstance(table, dict):
        raise CourseError(f"{where}: expected a table [{where}]")
    _known(table, where, {"title", "deadline", "points", "bonus"})
    deadline = table.get("deadline")
    if deadline is not None and (not isinstance(deadline, datetime) or deadline.tzinfo is not None):
        raise CourseError(f"{where}.deadline: {deadline!r}, expected local time, 2026-10-11T23:59:00")
    points, bonus = (
        {key: _number(f"{where}.{part}.{key}", value) for key, value in _table(table, where, part).items()}
        for part in ("points", "bonus")
    )
    if points and not math.isclose(sum(points.values()), POINTS_PER_WEEK):
        raise CourseError(f"{where}.points: they sum to {sum(points.values()):g}, expected {POINTS_PER_WEEK}")
    if twice := sorted(points.keys() & bonus.keys()):
        raise CourseError(f"{where}: {', '.join(twice)} is in points and in bonus")
    return Week(_text(table, where, "title"), deadline and deadline.replace(tzinfo=zone), points, bonus)


_Settings = TypeVar("_Settings", Late, Limits)


def _numbers(cls: type[_Settings], table: dict[str, Any], part: str) -> _Settings:
    values = _table(table, "", part)
    _known(values, part, {item.name for item in fields(cls)})
    return cls(**{key: _number(f"{part}.{key}", value) for key, value in values.items()})


def _known(table: dict[str, Any], where: str, names: set[str]) -> None:
    if strange := sorted(table.keys() - names):
        known = ", ".join(sorted(names))
        raise CourseError(f"{where or 'top level'}: unknown key {strange[0]!r}, known: {known}")


def _table(table: dict[str, Any], where: str, key: str) -> dict[str, Any]:
    value = table.get(key, {})
    if not isinstance(value, dict):
        raise CourseError(f"{where}.{key}: {value!r}, expected a table".lstrip("."))
    return value


def _text(table: dict[str, Any], where: str, key: str) -> str:
    value = table.get(key)
    if not isinstance(value, str) or not value:
        raise CourseError(f"{where}.{key}: {value!r}, expected a text".lstrip("."))
    return value


def _number(where: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value < math.inf:
        raise CourseError(f"{where}: {value!r}, expected a number of at least 0")
    return float(value)
