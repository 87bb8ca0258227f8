"""Tasks and scenarios as data, and the catalog of all tasks: course.toml and the check files."""

from __future__ import annotations

import ast
import math
import os
import re
import runpy
import signal
import sys
import threading
import tomllib
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from io import StringIO
from numbers import Real
from pathlib import Path
from typing import Any, Literal, NoReturn, get_args

from course_lib.course.course_file import CourseFile, read_course_file
from course_lib.course.material import ASSETS, asset_files, exercises_dir
from course_lib.errors import CourseError, did_you_mean, format_count, location_of
from course_lib.grading.evidence import Check, all_checks
from course_lib.grading.executors import (
    CAN_FORK,
    IDLE_SHARE,
    ChildDiedError,
    busy_seconds,
    call_in_child,
)
from course_lib.ros.messages.definitions import add_package, field_definitions
from course_lib.ros.programs.packages import MANIFEST, has_interfaces, packages_below, prepend_paths
from course_lib.third_party import read_text

Kind = Literal["node", "function", "value", "text", "file", "launch", "written"]
KINDS: tuple[str, ...] = get_args(Kind)
ON_A_GRAPH = ("node", "launch")  # kinds whose nodes run until the scenario ends
HINTS = 3  # number of hints of a task, shown one by one after the hint for the mistake
LONGEST = 3600.0  # [s] maximum robot time
MAX_SEED = 2**32 - 1  # of NumPy
_TOPIC = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")
_WEEK_FOLDER = re.compile(rf"{ASSETS}/(week\d\d)/")


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
    """Replace each `my(...)` by the student's personal value, also inside lists, tuples and dicts."""
    if isinstance(value, My):
        if value.name not in personal:
            raise CourseError(f"my({value.name!r}) is not in the task's personal table: {sorted(personal)}")
        personal_value = personal[value.name]
        return personal_value if value.times is None else personal_value * value.times
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
        best_effort: Whether it is published with Best Effort, as sensors do, and not with Reliable.
    """

    topic: str
    type_name: str
    fields: Mapping[str, Any]
    at: float = 0.0
    best_effort: bool = False


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
        is_named = isinstance(self.name, str) and self.name != ""
        _require(is_named, f"a scenario's name: {self.name!r}, expected a string that is not empty")
        is_seed = isinstance(self.seed, int) and 0 <= self.seed <= MAX_SEED
        _require(is_seed, f"seed={self.seed!r}, expected an integer from 0 to {MAX_SEED}")
        _require_number("seconds", self.seconds)
        expected = f"expected more than 0 and at most {LONGEST:g}"
        _require(0 < self.seconds <= LONGEST, f"seconds={self.seconds:g}: {expected}")
        for name, item_type in {"inputs": Message, "calls": Call, "checks": Check}.items():
            _require_tuple(name, getattr(self, name), item_type)
        for message in self.inputs:
            expected = "expected a full name of letters, digits and _, like '/goal_pose'"
            is_full = _TOPIC.fullmatch(str(message.topic))
            _require(is_full, f"an input on {message.topic!r}, {expected}")
            _require_number(f"the `at` of an input on {message.topic}", message.at)
        _require(
            all(0 <= m.at <= self.seconds for m in self.inputs), "an input's `at` is outside the scenario"
        )
        # Tasks without calls have one value: the submitted one.
        count = max(len(self.calls), 1)
        for origin in (check.origin for check in all_checks(self.checks) if check.origin):
            subject = f"{origin.check_function}: call={origin.arguments.get('call')}"
            _require(
                0 <= origin.arguments.get("call", 0) < count,
                f"{subject}, expected the index of a call, from 0 to {count - 1}: the scenario "
                f"{self.name!r} has {format_count(len(self.calls), 'call')}",
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
        for check in (check for scenario in self.scenarios for check in scenario.checks):
            if check.origin and check.origin.check_function.startswith("expect_launch_"):
                subject = (
                    f"{self.id}, kind {self.kind!r}: {check.origin.check_function} at {check.origin.location}"
                )
                _require(self.kind == "launch", f"{subject} needs kind 'launch', which runs the launch file")
        for name, options in self.personal.items():
            subject = f"{self.id}: personal {name!r}: {options!r}, expected a tuple of options"
            _require(isinstance(options, tuple) and options, f"{subject} (one item needs a comma, too)")
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


def _require_number(subject: str, value: Any) -> None:
    _require(isinstance(value, Real), f"{subject}: {value!r}, expected a number of seconds")


def _require_tuple(subject: str, value: Any, item_type: type) -> None:
    if isinstance(value, tuple) and all(isinstance(item, item_type) for item in value):
        return
    items = value if isinstance(value, tuple) else ()
    wrong = next((item for item in items if not isinstance(item, item_type)), value)
    expected = f"expected a tuple of {item_type.__name__} (one item needs a comma, too)"
    if item_type is Check and callable(wrong):
        name = getattr(wrong, "__name__", type(wrong).__name__)
        expected = f'the function {name} is not a check yet. Write Check("the row\'s title", {name})'
    raise CourseError(f"{subject}: {value!r}, {expected}")


@dataclass(frozen=True)
class Catalog:
    """The tasks of the course, as the grader and `check` use them.

    Args:
        course: The settings of course.toml.
        tasks: The tasks by id, in the order of the exercises.
        hidden: Hidden scenarios by task id; empty in a student's copy.
        faults: Error messages of weeks with invalid files; the other weeks can be used.
        assets: Contents of the course's own files by the path in a student's folder, `assets/…`.
    """

    course: CourseFile
    tasks: Mapping[str, Task]
    hidden: Mapping[str, tuple[Scenario, ...]] = field(default_factory=dict)
    faults: Mapping[str, str] = field(default_factory=dict)
    assets: Mapping[str, bytes] = field(default_factory=dict)

    def task(self, task_id: str) -> Task:
        """Return the task with an id.

        Raises:
            CourseError: No task has this id (the message suggests similar ids), or its week has
                invalid files.
        """
        self._require_valid(str(task_id).split(".")[0])
        if task_id not in self.tasks:
            suggestion = (
                did_you_mean(str(task_id), self.tasks, 3) or f"; the tasks are {', '.join(self.tasks)}."
            )
            raise CourseError(f"there is no task {task_id!r}{suggestion}")
        return self.tasks[task_id]

    def tasks_of_week(self, week: str) -> list[Task]:
        """Return the tasks of one week, in order.

        Raises:
            CourseError: The week's files are invalid.
        """
        self._require_valid(week)
        return [task for task in self.tasks.values() if task.week == week]

    def points(self, task: Task) -> tuple[float, bool]:
        """Return the task's points, and whether they are a bonus on top of the week's 100."""
        week, name = self.course.weeks[task.week], task.id.split(".")[1]
        return (week.bonus[name], True) if name in week.bonus else (week.points[name], False)

    def with_assets(self, week: str, files: Mapping[str, str]) -> dict[str, str | bytes]:
        """Return a submission's files and its week's assets, without assets of other weeks.

        If an asset changes, the submissions that can read it are run again.
        """
        assets = {
            name: content
            for name, content in self.assets.items()
            if not (other := _WEEK_FOLDER.match(name)) or other[1] == week
        }
        return dict[str, str | bytes](files) | assets

    def _require_valid(self, week: str) -> None:
        if week in self.faults:
            raise CourseError(self.faults[week])


def load_catalog(exercises: Path, solutions: Path | None = None) -> Catalog:
    """Read course.toml, the public check files and, if `solutions` is given, the hidden ones.

    A week with an invalid file gets an entry in `faults` and does not affect the other weeks.

    Raises:
        CourseError: course.toml can't be read.
    """
    course = read_course_file(exercises / "course.toml")
    tasks: dict[str, Task] = {}
    hidden: dict[str, tuple[Scenario, ...]] = {}
    faults = {**_weeks_without_points(exercises, course), **course.faults}
    # Week 0 has no tasks.
    for week in (week for week, settings in course.weeks.items() if settings.points):
        try:
            tasks_of_week = _load_week(exercises, course, week, is_limited=solutions is not None)
            hidden |= _load_hidden(solutions / "checks" / f"{week}.py", tasks_of_week) if solutions else {}
            # In a student's copy the hidden checks are missing, which may be the only ones with a
            # weight.
            if solutions:
                _reject_weightless(exercises / "checks" / f"{week}.py", tasks_of_week, hidden)
            tasks |= tasks_of_week
        except CourseError as error:
            faults[week] = str(error)
    return Catalog(course, tasks, hidden, faults, _load_assets(exercises / ASSETS, course))


def _load_assets(folder: Path, course: CourseFile) -> dict[str, bytes]:
    """Return the contents of the assets, and register their message types in this process.

    Raises:
        CourseError: The assets are too large, or a message file is invalid.
    """
    paths = asset_files(folder)
    megabytes = {path: path.stat().st_size / 1e6 for path in paths}
    total, limit = sum(megabytes.values()), course.limits.scratch_megabytes / 2
    if total > limit:
        largest = max(paths, key=megabytes.__getitem__)
        raise CourseError(
            f"{folder} has {total:.0f} MB, expected at most {limit:g} MB, half of the folder in "
            f"which a submission runs. Make {largest.name} ({megabytes[largest]:.0f} MB) smaller, "
            "or raise scratch_megabytes in [limits]"
        )
    if any(path.name == MANIFEST for path in paths):
        prepend_paths("ROS_PACKAGE_PATH", [folder.resolve()])
        known = {name.split("/")[0] for name in field_definitions()}
        for name, package in packages_below(folder.resolve()).items():
            # Evidence is judged in other processes, which decode known types only.
            if name not in known and has_interfaces(package):
                add_package(package, name)
    return {f"{ASSETS}/{path.relative_to(folder).as_posix()}": path.read_bytes() for path in paths}


def _reject_weightless(
    path: Path, tasks: Mapping[str, Task], hidden: Mapping[str, tuple[Scenario, ...]]
) -> None:
    """Reject a task whose checks all have the weight 0, because it could give no points."""
    for task in (task for task in tasks.values() if not task.rubric):
        scenarios = task.scenarios + hidden.get(task.id, ())
        checks = [check for scenario in scenarios for check in scenario.checks]
        if checks and not any(check.weight for check in checks):
            place = location_of(path, f'"{task.id}"')
            raise CourseError(
                f"{place}: {task.id}: all its checks have the weight 0, so it gives no points: "
                "remove worth(0) from checks that should count"
            )


def _weeks_without_points(exercises: Path, course: CourseFile) -> dict[str, str]:
    """Return an error message for each check file whose week has no points in course.toml."""
    weeks = {path.stem: path for path in sorted((exercises / "checks").glob("week*.py"))}
    return {
        week: f"{exercises / 'course.toml'} has no points for {week}, but {path} exists: "
        f"add [weeks.{week}] with a title, and [weeks.{week}.points] with the points of its tasks"
        for week, path in weeks.items()
        if week not in course.faults and not (week in course.weeks and course.weeks[week].points)
    }


def _load_week(
    exercises: Path,
    course: CourseFile,
    week: str,
    *,
    is_limited: bool,
) -> dict[str, Task]:
    """Return the public tasks of a week, including the course's hints for them."""
    settings = course.weeks[week]
    names = {f"{week}.{name}" for name in (*settings.points, *settings.bonus)}
    path = exercises / "checks" / f"{week}.py"
    tasks_of_file = _run_check_file(path, is_limited=is_limited).get("TASKS")
    if not isinstance(tasks_of_file, tuple) or not all(isinstance(task, Task) for task in tasks_of_file):
        raise CourseError(f"{path}: TASKS: expected a tuple of Task (one item needs a comma, too)")
    ids = sorted(task.id for task in tasks_of_file)
    if ids != sorted(names):
        raise CourseError(f"{path} has the tasks {ids}, but course.toml has points for {sorted(names)}")
    tasks = {task.id: task for task in tasks_of_file}
    return tasks | _load_hints(exercises / "mistakes" / f"{week}.toml", tasks)


@lru_cache(maxsize=1)
def shipped_catalog() -> Catalog:
    """Return the public tasks of the installation."""
    return load_catalog(exercises_dir())


def _load_hints(path: Path, tasks: Mapping[str, Task]) -> dict[str, Task]:
    """Return the tasks for which the hints file has entries, with these hints.

    The file may be missing.
    """
    try:
        tables = tomllib.loads(read_text(path)) if path.is_file() else dict[str, Any]()
    except ValueError as error:
        raise CourseError(f"{path}: {error}") from error
    hints = {f"{path.stem}.{name}": table for name, table in tables.items()}
    for task_id, table in hints.items():
        if task_id not in tasks:
            place = location_of(path, f"[{task_id.partition('.')[2]}]")
            raise CourseError(f"{place}: unknown task {task_id!r}, known: {', '.join(tasks)}")
        if not isinstance(table, dict) or not all(isinstance(hint, str) for hint in table.values()):
            raise CourseError(f"{path}: {task_id}: expected a table of kinds of mistakes and their hints")
    return {task_id: replace(tasks[task_id], mistakes=table) for task_id, table in hints.items()}


def _load_hidden(path: Path, tasks: Mapping[str, Task]) -> dict[str, tuple[Scenario, ...]]:
    hidden = _run_check_file(path, is_limited=True).get("HIDDEN")
    if not isinstance(hidden, dict):
        raise CourseError(f"{path}: HIDDEN: expected a dict of task id to scenarios")
    for task_id, scenarios in hidden.items():
        if task_id not in tasks:
            place = location_of(path, f'"{task_id}"')
            raise CourseError(f"{place}: HIDDEN: unknown task {task_id!r}, known: {', '.join(tasks)}")
        try:
            check_scenarios(task_id, tasks[task_id].scenarios + check_scenarios(task_id, scenarios))
        except CourseError as error:
            raise CourseError(f"{location_of(path, task_id)}: {error}") from error
    return dict(hidden)


# The timer repeats after this processor time [s], for code that swallows the first exception.
AGAIN = 1.0
# A block that is idle for these seconds of wall time is not slow, it waits: for a process, a lock
# or the network.
WAIT_SECONDS = 20.0
# Processor time [s] for the definitions of a check file, which may read data and import packages.
LOAD_SECONDS = 30.0
# Address space [bytes] that code of the course may use in addition to that of the grader.
COURSE_CODE_BYTES = 6_000_000_000
# Functions of `os` that end or duplicate the grader before an exception could name their line.
FATAL_CALLS = ("_exit", "abort", "fork", "forkpty", "execv", "execve")
# Functions that send a signal, for which the same holds if this process receives it.
SIGNAL_CALLS = ("kill", "killpg")


class _TimeLimitError(BaseException):
    """Raised when the time limit expires.

    A BaseException, so that `except Exception` does not catch it.
    """


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Limit the processor time of a block, in the main thread only.

    Raises:
        TimeoutError: The block took more than `seconds`, or waited without using a processor. Its
            traceback has the line of the block.
    """
    reason, busy = "", busy_seconds(os.getpid())

    def ring(number: int, _: Any) -> None:
        nonlocal reason, busy
        before, busy = busy, busy_seconds(os.getpid())
        if number == signal.SIGPROF:
            reason = f"it takes more than {seconds:.3g} s"
        elif busy - before > IDLE_SHARE * WAIT_SECONDS:
            return
        else:
            reason = f"it waits for something, without computing for {WAIT_SECONDS:.3g} s"
        raise _TimeLimitError

    is_main = threading.current_thread() is threading.main_thread()
    if not hasattr(signal, "setitimer") or not is_main:
        # On Windows only a student's own code is checked, which needs no limit.
        yield
        return
    numbers = (signal.SIGPROF, signal.SIGALRM)
    handlers = [(number, signal.signal(number, ring)) for number in numbers]
    periods = (WAIT_SECONDS, WAIT_SECONDS)
    timers = (signal.ITIMER_PROF, (seconds, AGAIN)), (signal.ITIMER_REAL, periods)
    former_timers = [(timer, signal.setitimer(timer, *times)) for timer, times in timers]
    try:
        try:
            yield
        finally:
            for timer, _ in timers:
                signal.setitimer(timer, 0)
    except _TimeLimitError as error:
        raise TimeoutError(reason).with_traceback(error.__traceback__) from None
    finally:
        for number, handler in handlers:
            signal.signal(number, handler)
        for timer, times in former_timers:
            # Time limits may be nested, and the caller may have its own.
            signal.setitimer(timer, *times)


@contextmanager
def limit_course_code(seconds: float) -> Iterator[None]:
    """Turn what ends or stops the grader in a check file into an exception with its line.

    Check files are trusted, but a mistake in one of them must not stop the class: an endless loop,
    `input()`, a huge array, `os._exit`, `os.fork` or `os.kill` of copied code, or a thread that
    the grader would wait for when it ends.

    Raises:
        TimeoutError: See `time_limit`.
    """
    start_thread = threading.Thread.start

    def reject(name: str, *_: Any) -> NoReturn:
        raise RuntimeError(f"{name} would end or duplicate the grader: remove this call")

    def send(name: str, call: Callable[[int, int], None], target: int, number: int) -> None:
        # Other processes may get signals: subprocess.run() ends a program after its timeout.
        if target <= 0 or target in (os.getpid(), os.getppid(), os.getpgrp()):
            reject(f"os.{name}({target}, {number})")
        call(target, number)

    def start(thread: threading.Thread) -> None:
        thread.daemon = True
        start_thread(thread)

    signal_calls = [name for name in SIGNAL_CALLS if hasattr(os, name)]
    replacements: list[tuple[Any, str, Callable[..., None]]] = [
        *((os, name, partial(reject, f"os.{name}")) for name in FATAL_CALLS if hasattr(os, name)),
        *((os, name, partial(send, name, getattr(os, name))) for name in signal_calls),
        (signal, "raise_signal", partial(reject, "signal.raise_signal")),
        (threading.Thread, "start", start),
    ]
    originals = [(owner, name, getattr(owner, name)) for owner, name, _ in replacements]
    used, old_limits = Path("/proc/self/statm"), (0, 0)
    if used.is_file():
        import resource

        old_limits = resource.getrlimit(resource.RLIMIT_AS)
        bytes_now = int(used.read_text().split()[0]) * resource.getpagesize()
        finite = [limit for limit in old_limits if limit != resource.RLIM_INFINITY]
        soft_limit = min([bytes_now + COURSE_CODE_BYTES, *finite])
        resource.setrlimit(resource.RLIMIT_AS, (soft_limit, old_limits[1]))
    keyboard, sys.stdin = sys.stdin, StringIO()
    for owner, name, function in replacements:
        setattr(owner, name, function)
    try:
        with time_limit(seconds):
            yield
    finally:
        for owner, name, function in originals:
            setattr(owner, name, function)
        sys.stdin = keyboard
        if used.is_file():
            resource.setrlimit(resource.RLIMIT_AS, old_limits)


def _run_check_file(path: Path, *, is_limited: bool) -> dict[str, Any]:
    """Return the names of a check file. In a student's kernel it runs without limits."""
    if not path.is_file():
        raise CourseError(f"{path} is missing: every week with points in course.toml needs a check file")

    def run() -> dict[str, Any]:
        with limit_course_code(LOAD_SECONDS) if is_limited else nullcontext():
            return runpy.run_path(str(path))

    if is_limited and CAN_FORK:
        # Only another process can report a crash of C code, as by ctypes. Exceptions are raised
        # again below, where they have a traceback.
        try:
            call_in_child(lambda: len(run()))
        except ChildDiedError as error:
            line = next((f" line {line}" for file, line in error.places if file == str(path)), "")
            raise CourseError(f"{path}{line}: {error}. Correct or remove this code") from None
        except CourseError:
            pass
    try:
        return run()
    except SyntaxError as error:
        raise CourseError(f"{error.filename} line {error.lineno}: SyntaxError: {error.msg}") from error
    except CourseError as error:
        raise CourseError(f"{_location(path, error)}: {error}") from error
    except (Exception, SystemExit) as error:
        # A check file is a program and can raise any exception, whose message lacks the file's
        # name. sys.exit() would end the command as if it had succeeded.
        text = f"{_location(path, error)}: {type(error).__name__}: {error}"
        suggestion = did_you_mean(str(error.name), _names_in(path)) if isinstance(error, NameError) else ""
        raise CourseError(f"{text}{suggestion}") from error


def _location(path: Path, error: BaseException) -> str:
    """Return the file, with the last of its lines in an exception's traceback."""
    lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == str(path)]
    return f"{path} line {lines[-1]}" if lines else str(path)


def _names_in(path: Path) -> set[str]:
    """Return the names that a check file imports, assigns or defines."""
    nodes = list(ast.walk(ast.parse(read_text(path))))
    imports = {
        a.asname or a.name for n in nodes if isinstance(n, ast.ImportFrom | ast.Import) for a in n.names
    }
    assigned = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    defined = {n.name for n in nodes if isinstance(n, ast.FunctionDef | ast.ClassDef)}
    return imports | assigned | defined
