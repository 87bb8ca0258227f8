"""Tasks and scenarios as data, for a week's check files."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from numbers import Real
from typing import Any, Literal, get_args

from course_lib.errors import CourseError
from course_lib.grading.evidence import Check

Kind = Literal["node", "function", "value", "text", "file", "written"]
KINDS: tuple[str, ...] = get_args(Kind)
HINTS = 3  # shown one by one, after the hint of the mistake
LONGEST = 3600.0  # [s] of robot time


@dataclass(frozen=True)
class My:
    """The place of a value that depends on the student; see `my`."""

    name: str
    times: float | None = None


def my(name: str, *, times: float | None = None) -> Any:
    """Refer to the student's own value in the task's `personal` table, as an argument of checks and inputs.

    Args:
        name: In the table.
        times: A factor, for what is in proportion to the value.
    """
    return My(name, times)


def resolve(value: Any, personal: Mapping[str, Any]) -> Any:
    """Put the student's own values in place of every `my(...)`, also inside lists, tuples and dicts."""
    if isinstance(value, My):
        if value.name not in personal:
            raise CourseError(f"my({value.name!r}) is not in the task's personal table: {sorted(personal)}")
        own = personal[value.name]
        return own if value.times is None else own * value.times
    if isinstance(value, (list, tuple)):
        return type(value)(resolve(item, personal) for item in value)
    if isinstance(value, Mapping):
        return {key: resolve(item, personal) for key, item in value.items()}
    return value


class Call:
    """One call of a function task; arrays and tuples arrive as lists.

    Args:
        args: Plain values.
        kwargs: The same, by name.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.args = list(args)
        self.kwargs = kwargs


@dataclass(frozen=True)
class Message:
    """A message as plain data, published in a scenario.

    With the name and the type of a service it is a request, whose response nobody waits for.

    Args:
        topic: Its full name.
        type_name: "geometry_msgs/msg/Twist".
        fields: As `to_plain` gives them; those left out have their defaults.
        at: Time after the start of the scenario, [s].
    """

    topic: str
    type_name: str
    fields: Mapping[str, Any]
    at: float = 0.0


@dataclass(frozen=True)
class Row:
    """A row of a rubric: the text of a criterion, and its points."""

    text: str
    points: float


@dataclass(frozen=True)
class Scenario:
    """One run of the student's object: length, seed, inputs and checks.

    Args:
        name: Unique among the task's scenarios.
        seconds: Robot time; events due exactly at the end still happen.
        seed: Of everything random.
        inputs: What our side publishes.
        calls: What a function task is called with.
        checks: What judges the evidence.
    """

    name: str
    seconds: float = 5.0
    seed: int = 0
    inputs: tuple[Message, ...] = ()
    calls: tuple[Call, ...] = ()
    checks: tuple[Check, ...] = ()

    def __post_init__(self) -> None:
        _need(self.name != "", "a scenario needs a name")
        _need_number("seconds", self.seconds)
        _need(0 < self.seconds <= LONGEST, f"{self.seconds=}: expected 0 < seconds <= {LONGEST:g}")
        for name, item_type in {"inputs": Message, "calls": Call, "checks": Check}.items():
            _need_tuple(name, getattr(self, name), item_type)
        for message in self.inputs:
            _need_number(f"the `at` of an input on {message.topic}", message.at)
        _need(all(0 <= m.at <= self.seconds for m in self.inputs), "an input's `at` is outside the scenario")


@dataclass(frozen=True)
class Task:
    """One graded task; its points are in course.toml.

    Args:
        id: Week and name, "week01.post".
        title: A few words for tables.
        kind: What the student hands in.
        name: Its name in the notebook, used where no `check(...)` binds the object.
        hints: Three, from a nudge to nearly the answer; shown after the hint of the mistake.
        scenarios: The public ones.
        personal: Options for the student's own values, by name.
        ghost: The expected picture, as messages.
        rubric: For a task that a person marks.
        mistakes: Hints for kinds of mistakes, from `exercises/mistakes/`, before `vocabulary/hints.toml`.
    """

    id: str
    title: str
    kind: Kind
    name: str
    hints: tuple[str, ...]
    scenarios: tuple[Scenario, ...] = ()
    personal: Mapping[str, tuple[Any, ...]] = field(default_factory=dict)
    ghost: tuple[Message, ...] = ()
    rubric: tuple[Row, ...] = ()
    mistakes: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _need(re.fullmatch(r"week\d\d\.[a-z][a-z0-9_]*", self.id), f'{self.id!r}: expected "week01.post"')
        _need(self.kind in KINDS, f"{self.id}: kind {self.kind!r}, expected one of {', '.join(KINDS)}")
        _need(self.name.isidentifier(), f"{self.id}: name {self.name!r} is no Python name")
        _need_tuple(f"{self.id}: hints", self.hints, str)
        _need(len(self.hints) == HINTS, f"{self.id}: {len(self.hints)} hints, expected {HINTS}")
        check_scenarios(self.id, self.scenarios)
        for name, options in self.personal.items():
            what = f"{self.id}: personal {name!r}: {options!r}, expected a tuple of options"
            _need(isinstance(options, tuple) and options, f"{what} (mind the last comma)")
        _need_tuple(f"{self.id}: ghost", self.ghost, Message)
        _need_tuple(f"{self.id}: rubric", self.rubric, Row)
        _need(bool(self.rubric) == (self.kind == "written"), f"{self.id}: a rubric belongs to kind 'written'")
        points = [row.points for row in self.rubric]
        _need(all(math.isfinite(p) and p > 0 for p in points), f"{self.id}: rubric points must be above 0")

    @property
    def week(self) -> str:
        """The week's name, "week01"."""
        return self.id.split(".")[0]


def check_scenarios(task: str, scenarios: Any) -> tuple[Scenario, ...]:
    """Return the scenarios of one task, each of its own name.

    Raises:
        CourseError: It is no tuple of scenarios, or two have one name.
    """
    _need_tuple(f"{task}: scenarios", scenarios, Scenario)
    names = [scenario.name for scenario in scenarios]
    _need(len(set(names)) == len(names), f"{task}: two scenarios of one name in {names}")
    return tuple(scenarios)


def _need(condition: object, message: str) -> None:
    if not condition:
        raise CourseError(message)


def _need_number(what: str, value: Any) -> None:
    _need(isinstance(value, Real), f"{what}: {value!r}, expected a number of seconds")


def _need_tuple(what: str, value: Any, item_type: type) -> None:
    if not isinstance(value, tuple) or not all(isinstance(item, item_type) for item in value):
        raise CourseError(
            f"{what}: {value!r}, expected a tuple of {item_type.__name__} (mind the last comma)"
        )
