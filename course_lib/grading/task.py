"""Tasks and scenarios as data, for the check files of a week."""

from __future__ import annotations

import math
import re
import signal
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from numbers import Real
from typing import Any, Literal, get_args

from course_lib.errors import CourseError
from course_lib.grading.evidence import Check

# The timer repeats after this processor time [s], for code that swallows the first exception.
AGAIN = 1.0


class _TimeLimitError(BaseException):
    """Raised when the time limit expires. A BaseException, so that `except Exception` does not catch it."""


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Limit the processor time of a block; works in the main thread only.

    Raises:
        TimeoutError: The block took more than `seconds`.
    """

    def ring(*_: Any) -> None:
        raise _TimeLimitError

    if not hasattr(signal, "setitimer"):
        # On Windows only a student's own code is checked, which needs no limit.
        yield
        return
    before = signal.signal(signal.SIGPROF, ring)
    try:
        signal.setitimer(signal.ITIMER_PROF, seconds, AGAIN)
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
    except _TimeLimitError:
        raise TimeoutError(f"it takes more than {seconds:.3g} s") from None
    finally:
        signal.signal(signal.SIGPROF, before)


Kind = Literal["node", "function", "value", "text", "file", "launch", "written"]
KINDS: tuple[str, ...] = get_args(Kind)
ON_A_GRAPH = ("node", "launch")  # kinds whose nodes run until the scenario ends
HINTS = 3  # hints per task, shown one by one after the hint for the mistake
LONGEST = 3600.0  # [s] maximum robot time


@dataclass(frozen=True)
class My:
    """A placeholder for a value that depends on the student; see `my`."""

    name: str
    times: float | None = None


def my(name: str, *, times: float | None = None) -> Any:
    """Refer to a personal value of the student in the arguments of checks and inputs.

    Args:
        name: The value's name in the task's `personal` table.
        times: A factor by which the value is multiplied.
    """
    return My(name, times)


def resolve(value: Any, personal: Mapping[str, Any]) -> Any:
    """Replace every `my(...)` by the student's personal value, including inside lists, tuples and dicts."""
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
        args: Positional arguments, as plain values.
        kwargs: Keyword arguments, as plain values.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        self.args = list(args)
        self.kwargs = kwargs


@dataclass(frozen=True)
class Message:
    """A message as plain data, published in a scenario.

    With the name and the type of a service it is a request; its response is ignored.

    Args:
        topic: The full topic name.
        type_name: "geometry_msgs/msg/Twist".
        fields: Field values as returned by `to_plain`; omitted fields keep their defaults.
        at: Time after the start of the scenario, [s].
    """

    topic: str
    type_name: str
    fields: Mapping[str, Any]
    at: float = 0.0


@dataclass(frozen=True)
class Row:
    """A row of a rubric.

    Args:
        text: The criterion.
        points: The points for it.
    """

    text: str
    points: float


@dataclass(frozen=True)
class Scenario:
    """The length, seed, inputs and checks of one run of the student's object.

    Args:
        name: Unique among the task's scenarios.
        seconds: The length in robot time; events due exactly at the end still happen.
        seed: Seed of all random numbers.
        inputs: Messages that the grader publishes.
        calls: Calls of a function task.
        checks: The checks of the evidence.
    """

    name: str
    seconds: float = 5.0
    seed: int = 0
    inputs: tuple[Message, ...] = ()
    calls: tuple[Call, ...] = ()
    checks: tuple[Check, ...] = ()

    def __post_init__(self) -> None:
        _require(self.name != "", "a scenario needs a name")
        _require_number("seconds", self.seconds)
        _require(0 < self.seconds <= LONGEST, f"{self.seconds=}: expected 0 < seconds <= {LONGEST:g}")
        for name, item_type in {"inputs": Message, "calls": Call, "checks": Check}.items():
            _require_tuple(name, getattr(self, name), item_type)
        for message in self.inputs:
            _require_number(f"the `at` of an input on {message.topic}", message.at)
        _require(
            all(0 <= m.at <= self.seconds for m in self.inputs), "an input's `at` is outside the scenario"
        )


@dataclass(frozen=True)
class Task:
    """A graded task. Its points are in course.toml.

    Args:
        id: Week and name, "week01.post".
        title: A short title for tables.
        kind: The kind of object that the student submits.
        name: The object's name in the notebook, used if no `check(...)` binds the object.
        hints: Three hints, from a nudge to nearly the answer; shown after the hint for the mistake.
        scenarios: The public scenarios.
        personal: Options for the student's personal values, by name.
        ghost: The expected picture, as messages.
        rubric: The criteria of a task that is marked by a person.
        mistakes: Hints for kinds of mistakes, from `exercises/mistakes/`; they precede
            `vocabulary/hints.toml`.
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
        _require(re.fullmatch(r"week\d\d\.[a-z][a-z0-9_]*", self.id), f'{self.id!r}: expected "week01.post"')
        _require(self.kind in KINDS, f"{self.id}: kind {self.kind!r}, expected one of {', '.join(KINDS)}")
        _require(self.name.isidentifier(), f"{self.id}: name {self.name!r} is not a Python name")
        _require_tuple(f"{self.id}: hints", self.hints, str)
        _require(len(self.hints) == HINTS, f"{self.id}: {len(self.hints)} hints, expected {HINTS}")
        check_scenarios(self.id, self.scenarios)
        for check in (one for scenario in self.scenarios for one in scenario.checks):
            if check.origin and check.origin.check_function.startswith("expect_launch_"):
                what = f"{self.id}, kind {self.kind!r}: {check.origin.check_function} at {check.origin.place}"
                _require(self.kind == "launch", f"{what} needs kind 'launch', which runs the launch file")
        for name, options in self.personal.items():
            what = f"{self.id}: personal {name!r}: {options!r}, expected a tuple of options"
            _require(isinstance(options, tuple) and options, f"{what} (mind the last comma)")
        _require_tuple(f"{self.id}: ghost", self.ghost, Message)
        _require_tuple(f"{self.id}: rubric", self.rubric, Row)
        _require(
            bool(self.rubric) == (self.kind == "written"), f"{self.id}: a rubric belongs to kind 'written'"
        )
        points = [row.points for row in self.rubric]
        _require(all(math.isfinite(p) and p > 0 for p in points), f"{self.id}: rubric points must be above 0")

    @property
    def week(self) -> str:
        """The week's name, "week01"."""
        return self.id.split(".")[0]


def check_scenarios(task: str, scenarios: Any) -> tuple[Scenario, ...]:
    """Return the scenarios of one task if their names are unique.

    Raises:
        CourseError: The value is not a tuple of scenarios, or a name occurs twice.
    """
    _require_tuple(f"{task}: scenarios", scenarios, Scenario)
    names = [scenario.name for scenario in scenarios]
    _require(len(set(names)) == len(names), f"{task}: two scenarios have the same name in {names}")
    return tuple(scenarios)


def _require(condition: object, message: str) -> None:
    if not condition:
        raise CourseError(message)


def _require_number(what: str, value: Any) -> None:
    _require(isinstance(value, Real), f"{what}: {value!r}, expected a number of seconds")


def _require_tuple(what: str, value: Any, item_type: type) -> None:
    if not isinstance(value, tuple) or not all(isinstance(item, item_type) for item in value):
        raise CourseError(
            f"{what}: {value!r}, expected a tuple of {item_type.__name__} (mind the last comma)"
        )
