"""All tasks of the course: course.toml and the weeks' check files, checked against each other."""

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
from course_lib.course.installation import exercises_dir
from course_lib.errors import CourseError, did_you_mean, place_of
from course_lib.grading.task import Scenario, Task, check_scenarios


@dataclass(frozen=True)
class Catalog:
    """The course as the grader and `check` see it.

    Args:
        course: What course.toml says.
        tasks: By id, in the order of the exercises.
        hidden: Hidden scenarios by task id; empty in a student's copy.
        faults: By week, what is wrong with its files; the other weeks can be used.
    """

    course: CourseFile
    tasks: Mapping[str, Task]
    hidden: Mapping[str, tuple[Scenario, ...]] = field(default_factory=dict)
    faults: Mapping[str, str] = field(default_factory=dict)

    def task(self, task_id: str) -> Task:
        """Return a task.

        Raises:
            CourseError: No task has this id; the message names the close ones. Or its week is faulty.
        """
        self._demand(str(task_id).split(".")[0])
        if task_id not in self.tasks:
            meant = did_you_mean(str(task_id), self.tasks, 3) or f"; there is {', '.join(self.tasks)}."
            raise CourseError(f"there is no task {task_id!r}{meant}")
        return self.tasks[task_id]

    def of_week(self, week: str) -> list[Task]:
        """Return the tasks of one week, in order.

        Raises:
            CourseError: The week's files are faulty.
        """
        self._demand(week)
        return [task for task in self.tasks.values() if task.week == week]

    def points(self, task: Task) -> tuple[float, bool]:
        """Return the task's points, and whether they are a bonus on top of the week's 100."""
        week, name = self.course.weeks[task.week], task.id.split(".")[1]
        return (week.bonus[name], True) if name in week.bonus else (week.points[name], False)

    def _demand(self, week: str) -> None:
        if week in self.faults:
            raise CourseError(self.faults[week])


def load_catalog(exercises: Path, solutions: Path | None = None) -> Catalog:
    """Read course.toml, the public check files and, if `solutions` is given, the hidden ones.

    A week with a faulty file is kept as a fault: it must not break the others.

    Raises:
        CourseError: course.toml can't be read.
    """
    course = read_course_file(exercises / "course.toml")
    tasks: dict[str, Task] = {}
    hidden: dict[str, tuple[Scenario, ...]] = {}
    faults = {**_unnamed(exercises, course), **course.faults}
    for week in (week for week, settings in course.weeks.items() if settings.points):  # week 0 has no tasks
        try:
            of_week = _week(exercises, course, week)
            hidden |= _hidden(solutions / "checks" / f"{week}.py", of_week) if solutions else {}
            tasks |= of_week
        except CourseError as error:
            faults[week] = str(error)
    return Catalog(course, tasks, hidden, faults)


def _unnamed(exercises: Path, course: CourseFile) -> dict[str, str]:
    """Return a fault for each check file whose week has no points in course.toml."""
    weeks = {path.stem: path for path in sorted((exercises / "checks").glob("week*.py"))}
    return {
        week: f"{exercises / 'course.toml'} has no points for {week}, but there is {path}: "
        f"write [weeks.{week}] with a title, and [weeks.{week}.points] with the points of its tasks"
        for week, path in weeks.items()
        if week not in course.faults and not (week in course.weeks and course.weeks[week].points)
    }


def _week(exercises: Path, course: CourseFile, week: str) -> dict[str, Task]:
    """Return the public tasks of a week, with its own hints."""
    settings = course.weeks[week]
    names = {f"{week}.{name}" for name in (*settings.points, *settings.bonus)}
    tasks = _tasks(exercises / "checks" / f"{week}.py", names)
    return tasks | _with_hints(exercises / "mistakes" / f"{week}.toml", tasks)


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
            place = place_of(path, f"[{task_id.partition('.')[2]}]")
            raise CourseError(f"{place}: unknown task {task_id!r}, known: {', '.join(tasks)}")
        if not isinstance(table, dict) or not all(isinstance(hint, str) for hint in table.values()):
            raise CourseError(f"{path}: {task_id}: expected a table of kinds of mistakes and their hints")
    return {task_id: replace(tasks[task_id], mistakes=table) for task_id, table in hints.items()}


def _hidden(path: Path, tasks: Mapping[str, Task]) -> dict[str, tuple[Scenario, ...]]:
    hidden = _run(path).get("HIDDEN")
    if not isinstance(hidden, dict):
        raise CourseError(f"{path}: HIDDEN: expected a dict of task id to scenarios")
    for task_id, scenarios in hidden.items():
        if task_id not in tasks:
            place = place_of(path, f'"{task_id}"')
            raise CourseError(f"{place}: HIDDEN: unknown task {task_id!r}, known: {', '.join(tasks)}")
        try:
            check_scenarios(task_id, tasks[task_id].scenarios + check_scenarios(task_id, scenarios))
        except CourseError as error:
            raise CourseError(f"{place_of(path, task_id)}: {error}") from error
    return dict(hidden)


def _run(path: Path) -> dict[str, Any]:
    if not path.is_file():
        raise CourseError(f"{path} is missing: every week with points in course.toml has its check file")
    try:
        return runpy.run_path(str(path))
    except SyntaxError as error:
        raise CourseError(f"{error.filename} line {error.lineno}: SyntaxError: {error.msg}") from error
    except CourseError as error:
        raise CourseError(f"{_place(path, error)}: {error}") from error
    except Exception as error:  # a check file is a program: whatever it raises, the file must be named
        text = f"{_place(path, error)}: {type(error).__name__}: {error}"
        meant = did_you_mean(str(error.name), _names_in(path)) if isinstance(error, NameError) else ""
        raise CourseError(f"{text}{meant}") from error


def _place(path: Path, error: Exception) -> str:
    """Return the file with the line that an exception came through last."""
    lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == str(path)]
    return f"{path} line {lines[-1]}" if lines else str(path)


def _names_in(path: Path) -> set[str]:
    """Return the names that a check file imports or assigns."""
    nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
    imported = {
        a.asname or a.name for n in nodes if isinstance(n, ast.ImportFrom | ast.Import) for a in n.names
    }
    assigned = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    defined = {n.name for n in nodes if isinstance(n, ast.FunctionDef | ast.ClassDef)}
    return imported | assigned | defined
