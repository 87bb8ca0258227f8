"""All tasks of the course: course.toml and the weeks' check files, checked against each other."""

import runpy
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from course_lib.course.course_file import CourseFile, read_course_file
from course_lib.course.installation import exercises_dir
from course_lib.errors import CourseError, did_you_mean
from course_lib.grading.task import Scenario, Task, check_scenarios


@dataclass(frozen=True)
class Catalog:
    """The course as the grader and `check` see it.

    Args:
        course: What course.toml says.
        tasks: By id, in the order of the exercises.
        hidden: Hidden scenarios by task id; empty in a student's copy.
    """

    course: CourseFile
    tasks: Mapping[str, Task]
    hidden: Mapping[str, tuple[Scenario, ...]] = field(default_factory=dict)

    def task(self, task_id: str) -> Task:
        """Return a task.

        Raises:
            CourseError: No task has this id; the message names the close ones.
        """
        if task_id not in self.tasks:
            meant = did_you_mean(str(task_id), self.tasks, 3) or f"; there is {', '.join(self.tasks)}."
            raise CourseError(f"there is no task {task_id!r}{meant}")
        return self.tasks[task_id]

    def of_week(self, week: str) -> list[Task]:
        """Return the tasks of one week, in order."""
        return [task for task in self.tasks.values() if task.week == week]

    def points(self, task: Task) -> tuple[float, bool]:
        """Return the task's points, and whether they are a bonus on top of the week's 100."""
        week, name = self.course.weeks[task.week], task.id.split(".")[1]
        return (week.bonus[name], True) if name in week.bonus else (week.points[name], False)


def load_catalog(exercises: Path, solutions: Path | None = None) -> Catalog:
    """Read course.toml, the public check files and, if `solutions` is given, the hidden ones.

    Raises:
        CourseError: Naming the file and what is wrong in it.
    """
    course = read_course_file(exercises / "course.toml")
    tasks: dict[str, Task] = {}
    hidden: dict[str, tuple[Scenario, ...]] = {}
    for week, settings in course.weeks.items():
        if not settings.points:
            continue  # a week without tasks, such as week 0
        names = [*settings.points, *settings.bonus]
        of_week = _tasks(exercises / "checks" / f"{week}.py", {f"{week}.{name}" for name in names})
        tasks |= of_week | _with_hints(exercises / "mistakes" / f"{week}.toml", of_week)
        if solutions is not None:
            hidden |= _hidden(solutions / "checks" / f"{week}.py", of_week)
    return Catalog(course, tasks, hidden)


@lru_cache(maxsize=1)
def shipped_catalog() -> Catalog:
    """Return the public tasks of the installation."""
    return load_catalog(exercises_dir())


def _tasks(path: Path, with_points: set[str]) -> dict[str, Task]:
    tasks = _run(path).get("TASKS")
    if not isinstance(tasks, tuple) or not all(isinstance(task, Task) for task in tasks):
        raise CourseError(f"{path}: TASKS: expected a tuple of Task (mind the last comma)")
    ids = sorted(task.id for task in tasks)
    if ids != sorted(with_points):
        raise CourseError(f"{path} has the tasks {ids}, but course.toml has points for {sorted(with_points)}")
    return {task.id: task for task in tasks}


def _with_hints(path: Path, tasks: Mapping[str, Task]) -> dict[str, Task]:
    """Return the tasks for which the file has hints, with these; the file may be missing."""
    try:
        tables = tomllib.loads(path.read_text(encoding="utf-8")) if path.is_file() else dict[str, Any]()
    except ValueError as error:
        raise CourseError(f"{path}: {error}") from error
    hints = {f"{path.stem}.{name}": table for name, table in tables.items()}
    for task_id, table in hints.items():
        if task_id not in tasks:
            raise CourseError(f"{path}: unknown task {task_id!r}, known: {', '.join(tasks)}")
        if not isinstance(table, dict) or not all(isinstance(hint, str) for hint in table.values()):
            raise CourseError(f"{path}: {task_id}: expected a table of kinds of mistakes and their hints")
    return {task_id: replace(tasks[task_id], mistakes=table) for task_id, table in hints.items()}


def _hidden(path: Path, tasks: Mapping[str, Task]) -> dict[str, tuple[Scenario, ...]]:
    hidden = _run(path).get("HIDDEN")
    if not isinstance(hidden, dict):
        raise CourseError(f"{path}: HIDDEN: expected a dict of task id to scenarios")
    for task_id, scenarios in hidden.items():
        if task_id not in tasks:
            raise CourseError(f"{path}: HIDDEN: unknown task {task_id!r}, known: {', '.join(tasks)}")
        try:
            check_scenarios(task_id, tasks[task_id].scenarios + check_scenarios(task_id, scenarios))
        except CourseError as error:
            raise CourseError(f"{path}: {error}") from error
    return dict(hidden)


def _run(path: Path) -> dict[str, Any]:
    if not path.is_file():
        raise CourseError(f"{path} is missing: every week with points in course.toml has its check file")
    try:
        return runpy.run_path(str(path))
    except Exception as error:  # a check file is a program: whatever it raises, the file must be named
        raise CourseError(f"{path}: {type(error).__name__}: {error}") from error
