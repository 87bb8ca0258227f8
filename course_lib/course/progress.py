"""A student's progress: the first page of the folder, and `course status`."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from zoneinfo import ZoneInfo

from rich.table import Table

from course_lib.course.course_file import CourseFile, WeekSettings, shipped_course_file
from course_lib.course.exercise import Notebook, read_notebook, source
from course_lib.course.hand_out import DEFAULT_FOLDER, content_hash
from course_lib.course.installation import exercises_dir, extras, lessons, reviews
from course_lib.course.state import Packed, State, find_student_folder, last_check, last_packed, write_whole
from course_lib.errors import CourseError, counted

CONTENTS_FILE = "contents.md"
PAGE = """\
# Contents and progress

*Every `course lab` writes this page again. Your own notes are safe in any other file.*

| lesson | minutes | exercise | hand in by | public checks passed |
|---|---|---|---|---|
{rows}

Check: `course check week01_exercise.ipynb`. Hand in: `course submit week01_exercise.ipynb`. \
How far you are now: `course status`.
"""
HEADINGS = ("week", "public checks", "points", "packed", "hand in by")
FAULTY = "unknown, as course.toml has a fault"  # instead of a deadline
HOURS_SHOWN = 72  # a deadline nearer than this is told in hours


@dataclass(frozen=True)
class Week:
    """One row of the page."""

    name: str  # "week01"
    title: str
    minutes: int  # [min] of the lesson
    lesson: str  # file name
    exercise: str | None  # file name
    settings: WeekSettings  # of course.toml
    is_faulty: bool = False  # its part of course.toml, which then tells nothing


def load_weeks() -> tuple[Week, ...]:
    """Return all weeks that have a lesson, in order; deadlines and points from course.toml."""
    course = shipped_course_file()
    return tuple(_week(path, course) for path in lessons())


def _week(lesson: Path, course: CourseFile) -> Week:
    notebook, name = read_notebook(lesson), lesson.stem.split("_")[0]
    exercise = exercises_dir() / f"{name}_exercise.ipynb"
    return Week(
        name=name,
        title=_title(notebook),
        minutes=notebook["metadata"]["course"]["minutes"],
        lesson=lesson.name,
        exercise=exercise.name if exercise.exists() else None,
        settings=course.weeks.get(name, WeekSettings("")),
        is_faulty=name in course.faults,
    )


def _title(notebook: Notebook) -> str:
    return source(notebook["cells"][0]).splitlines()[0].lstrip("# ")


@dataclass(frozen=True)
class Progress:
    """A student's progress in a week: passed public checks, and the file to hand in."""

    done: tuple[str, ...]  # tasks with all their points
    open: tuple[str, ...]
    points: float  # by the public checks; hidden ones come on top when graded
    packed: datetime | None  # when `course submit` last made a file of it
    file: Packed | None = None  # what it holds, if that is known
    changed: bool = False  # whether the notebook has changed since it was packed

    @property
    def tasks(self) -> str:
        """E.g. "2 of 4 tasks"; empty without tasks."""
        count = len(self.done) + len(self.open)
        return f"{len(self.done)} of {count} tasks" if count else ""


def progress(week: Week, state: State) -> Progress:
    """Return what the student's folder remembers of a week."""
    kept, packed = state.section("progress"), state.get("packed", f"{week.name}_exercise")
    none = {"score": 0.0, "of": 1.0}
    results = {task: kept.get(f"{week.name}.{task}", none) for task in week.settings.points}
    done = tuple(t for t, result in results.items() if _is_done(state, f"{week.name}.{t}", result))
    file = last_packed(state, f"{week.name}_exercise") if packed else None
    return Progress(
        done=done,
        open=tuple(task for task in results if task not in done),
        points=sum(result["score"] for result in results.values()),
        packed=datetime.fromisoformat(packed) if packed else None,
        file=file,
        changed=file is not None and _has_changed(file),
    )


def _is_done(state: State, task: str, result: Mapping[str, float]) -> bool:
    """Return whether a task has its points, or passed its checks where a person marks it."""
    last = last_check(state, task)
    return result["score"] >= result["of"] or (last is not None and last.passed)


def _has_changed(file: Packed) -> bool:
    source = Path(file.source)
    return source.is_file() and content_hash(source) != file.notebook


def contents_page(state: State) -> str:
    """Return the page as Markdown; links open inside JupyterLab."""
    rows = [row for week in load_weeks() for row in (_row(week, state), *map(_plain_row, _reviews(week)))]
    return PAGE.format(rows="\n".join([*rows, *map(_plain_row, extras())]))


def _reviews(week: Week) -> list[Path]:
    """Return the reviews that follow this week."""
    return [path for path in reviews() if path.name.startswith(week.name)]


def _plain_row(path: Path) -> str:
    """Return the row of a notebook without an exercise."""
    notebook = read_notebook(path)
    return f"| [{_title(notebook)}]({path.name}) | {notebook['metadata']['course']['minutes']} | | | |"


def _row(week: Week, state: State) -> str:
    deadline = week.settings.deadline
    cells = (
        f"[{week.title}]({week.lesson})",
        f"{week.minutes}",
        f"[{week.exercise}]({week.exercise})" if week.exercise else "",
        FAULTY if week.is_faulty else f"{deadline:%d %B %Y, %H:%M}" if deadline else "",
        progress(week, state).tasks,
    )
    return f"| {' | '.join(cells)} |"


def write_contents(folder: Path) -> Path:
    """Write the page into the student's folder."""
    path = folder / CONTENTS_FILE
    write_whole(path, contents_page(State(folder)).encode())
    return path


def status(folder: Path | None = None, now: datetime | None = None) -> tuple[Table, str]:
    """Return a line per week, then what the packed files hold and what to do next.

    Args:
        folder: The student's folder; default: the one around the working directory, else ./my_course.
        now: The time; default: that of the wall clock.

    Raises:
        CourseError: There is no student's folder.
    """
    found = find_student_folder(folder) or find_student_folder(folder or DEFAULT_FOLDER)
    if found is None:
        place = folder or Path.cwd()
        raise CourseError(f"{place} holds no {DEFAULT_FOLDER} of yours: type course lab first")
    now, zone, state = now or datetime.now(UTC), shipped_course_file().zone, State(found)
    table = Table(*HEADINGS, caption="Points are those of the public checks; grading adds hidden ones.")
    rows = [(week, progress(week, state)) for week in load_weeks()]
    for week, so_far in rows:
        table.add_row(*_cells(week, so_far, now, zone))
    packed = [_packed(week, so_far) for week, so_far in rows if so_far.packed]
    return table, "\n".join([*packed, _next(rows)])


def _cells(week: Week, so_far: Progress, now: datetime, zone: ZoneInfo) -> tuple[str, ...]:
    if week.exercise is None:
        return (week.title, "", "", "", "")
    if week.is_faulty:
        return (week.title, "", "", "", FAULTY)
    points = f"{so_far.points:g} of {sum(week.settings.points.values()):g}"
    packed = f"{so_far.packed.astimezone(zone):%d %b %H:%M}" if so_far.packed else "not yet"
    return (week.title, so_far.tasks, points, packed, _due(week.settings.deadline, now, zone))


def _due(deadline: datetime | None, now: datetime, zone: ZoneInfo) -> str:
    """Return the deadline, in local time of the course, and the time left."""
    if deadline is None:
        return "no deadline"
    left = deadline.replace(tzinfo=zone) - now
    hours = left.total_seconds() / 3600
    if hours < 0:
        told = "over"
    elif hours < HOURS_SHOWN:
        told = f"{hours:.0f} h left"
    else:
        told = f"{left.days} days left"
    return f"{deadline:%d %b %H:%M}, {told}"


def _packed(week: Week, so_far: Progress) -> str:
    """Return what the file that was packed last holds, and whether it still is what the notebook is."""
    file = so_far.file
    if file is None:
        return f"{week.exercise}: packed by an older version, which did not note what the file holds."
    path, source = Path(file.file), Path(file.source).name
    outcomes = "; ".join(f"{outcome}: {', '.join(names)}" for outcome, names in file.by_outcome.items())
    said = [f"{path.name} holds {counted(len(file.tasks), 'task')} of {source}, when packed {outcomes}."]
    if not path.is_file():
        said.append(f"It is no longer at {path}.")
    if so_far.changed:
        said.append(f"{source} has changed since: course submit {source}")
    return " ".join(said)


def _next(rows: list[tuple[Week, Progress]]) -> str:
    """Return a sentence that names the first open task."""
    for week, so_far in rows:
        if so_far.open:
            begun = "go on with" if so_far.done else "begin with"
            return f"Next: {begun} {so_far.open[0]} in {week.exercise}; the lesson is {week.lesson}."
        if week.exercise and so_far.changed:
            return f"Next: hand in {week.name} again, it has changed: course submit {week.exercise}"
        if week.exercise and so_far.packed is None:
            return f"Next: hand in {week.name}: course submit {week.exercise}"
    return "All exercises are done and packed."
