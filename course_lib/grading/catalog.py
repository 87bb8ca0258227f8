"""All tasks of the course: course.toml and the weeks' check files, validated against each other."""

import ast
import runpy
import tomllib
import traceback
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from course_lib.course.course_file import CourseFile, read_course_file
from course_lib.course.state import exercises_dir
from course_lib.errors import CourseError, did_you_mean, location_of
from course_lib.grading.task import Scenario, Task, check_scenarios


@dataclass(frozen=True)
class Catalog:
    """The tasks of the course, as the grader and `check` use them.

    Args:
        course: The settings of course.toml.
        tasks: The tasks by id, in the order of the exercises.
        hidden: Hidden scenarios by task id; empty in a student's copy.
        faults: Error messages of weeks with invalid files; the other weeks can be used.
    """

    course: CourseFile
    tasks: Mapping[str, Task]
    hidden: Mapping[str, tuple[Scenario, ...]] = field(default_factory=dict)
    faults: Mapping[str, str] = field(default_factory=dict)

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

    def of_week(self, week: str) -> list[Task]:
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
    for week in (week for week, settings in course.weeks.items() if settings.points):  # Week 0 has no tasks.
        try:
            of_week = _load_week(exercises, course, week)
            hidden |= _load_hidden(solutions / "checks" / f"{week}.py", of_week) if solutions else {}
            # In a student's copy the hidden checks are missing, which may be the only ones with a
            # weight.
            if solutions:
                _reject_weightless(exercises / "checks" / f"{week}.py", of_week, hidden)
            tasks |= of_week
        except CourseError as error:
            faults[week] = str(error)
    return Catalog(course, tasks, hidden, faults)


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


def _load_week(exercises: Path, course: CourseFile, week: str) -> dict[str, Task]:
    """Return the public tasks of a week, including the course's hints for them."""
    settings = course.weeks[week]
    names = {f"{week}.{name}" for name in (*settings.points, *settings.bonus)}
    path = exercises / "checks" / f"{week}.py"
    found = _run_check_file(path).get("TASKS")
    if not isinstance(found, tuple) or not all(isinstance(task, Task) for task in found):
        raise CourseError(f"{path}: TASKS: expected a tuple of Task (mind the last comma)")
    ids = sorted(task.id for task in found)
    if ids != sorted(names):
        raise CourseError(f"{path} has the tasks {ids}, but course.toml has points for {sorted(names)}")
    tasks = {task.id: task for task in found}
    return tasks | _load_hints(exercises / "mistakes" / f"{week}.toml", tasks)


@lru_cache(maxsize=1)
def shipped_catalog() -> Catalog:
    """Return the public tasks of the installation."""
    return load_catalog(exercises_dir())


def _load_hints(path: Path, tasks: Mapping[str, Task]) -> dict[str, Task]:
    """Return the tasks for which the hints file has entries, with these hints. The file may be missing."""
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else dict[str, Any]()
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
    hidden = _run_check_file(path).get("HIDDEN")
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


def _run_check_file(path: Path) -> dict[str, Any]:
    if not path.is_file():
        raise CourseError(f"{path} is missing: every week with points in course.toml needs a check file")
    try:
        return runpy.run_path(str(path))
    except SyntaxError as error:
        raise CourseError(f"{error.filename} line {error.lineno}: SyntaxError: {error.msg}") from error
    except CourseError as error:
        raise CourseError(f"{_location(path, error)}: {error}") from error
    except Exception as error:
        # A check file is a program and can raise anything; the message must name the file.
        text = f"{_location(path, error)}: {type(error).__name__}: {error}"
        suggestion = did_you_mean(str(error.name), _names_in(path)) if isinstance(error, NameError) else ""
        raise CourseError(f"{text}{suggestion}") from error


def _location(path: Path, error: Exception) -> str:
    """Return the file, with the last of its lines in an exception's traceback."""
    lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == str(path)]
    return f"{path} line {lines[-1]}" if lines else str(path)


def _names_in(path: Path) -> set[str]:
    """Return the names that a check file imports, assigns or defines."""
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    imported = {
        a.asname or a.name for n in nodes if isinstance(n, ast.ImportFrom | ast.Import) for a in n.names
    }
    assigned = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    defined = {n.name for n in nodes if isinstance(n, ast.FunctionDef | ast.ClassDef)}
    return imported | assigned | defined
