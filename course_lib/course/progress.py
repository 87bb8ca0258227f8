"""Progress: the page `contents.md` in the student's folder, and `course status`."""

from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from zoneinfo import ZoneInfo

from rich.table import Table

from course_lib.course.course_file import WeekSettings, shipped_course_file
from course_lib.course.exercise import Notebook, read_notebook, source
from course_lib.course.material import exercises_dir, extras, lessons, reviews
from course_lib.course.state import (
    PackedSubmission,
    State,
    find_student_folder,
    last_check,
    last_packed_submission,
)
from course_lib.course.student_folder import DEFAULT_FOLDER, content_hash
from course_lib.errors import CourseError, format_count
from course_lib.files import write_atomically

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
# Displayed instead of a deadline.
FAULTY = "unknown, as course.toml has a fault"
# Below this number of hours, the remaining time is displayed in hours, otherwise in days.
HOURS_SHOWN = 72


@dataclass(frozen=True)
class Week:
    """A row of the contents page."""

    # Like "week01".
    name: str
    title: str
    # Duration of the lesson [min].
    minutes: int
    # File names.
    lesson: str
    exercise: str | None
    # The week's table in course.toml.
    settings: WeekSettings
    # Whether the table has an error, so that the deadline is unknown.
    is_faulty: bool = False


def read_weeks() -> tuple[Week, ...]:
    """Return all weeks that have a lesson, in order, with deadlines and points from course.toml."""
    course, weeks = shipped_course_file(), []
    for lesson in lessons():
        notebook, name = read_notebook(lesson), lesson.stem.split("_")[0]
        exercise = exercises_dir() / f"{name}_exercise.ipynb"
        week = Week(
            name=name,
            title=_title(notebook),
            minutes=notebook["metadata"]["course"]["minutes"],
            lesson=lesson.name,
            exercise=exercise.name if exercise.exists() else None,
            settings=course.weeks.get(name, WeekSettings("")),
            is_faulty=name in course.faults,
        )
        weeks.append(week)
    return tuple(weeks)


def _title(notebook: Notebook) -> str:
    return source(notebook["cells"][0]).splitlines()[0].lstrip("# ")


@dataclass(frozen=True)
class Progress:
    """A student's progress in a week: passed public checks, and the file to hand in."""

    # Tasks with all points, and the others.
    done: tuple[str, ...]
    open: tuple[str, ...]
    # Points from public checks. Hidden checks are added at grading.
    points: float
    # Time of the last `course submit`.
    packed: datetime | None
    # The packed file, unless an older version of the kit wrote it.
    file: PackedSubmission | None = None
    # Whether the notebook has changed since it was packed.
    has_changed: bool = False

    @property
    def task_count(self) -> str:
        """The number of finished tasks, like "2 of 4 tasks"; "" without tasks."""
        count = len(self.done) + len(self.open)
        return f"{len(self.done)} of {count} tasks" if count else ""


def progress(week: Week, state: State) -> Progress:
    """Return the stored results and submissions of a week."""
    saved_results, packed = state.section("progress"), state.get("packed", f"{week.name}_exercise")
    none = {"score": 0.0, "of": 1.0}
    results = {task: saved_results.get(f"{week.name}.{task}", none) for task in week.settings.points}
    done = []
    for task, result in results.items():
        last = last_check(state, f"{week.name}.{task}")
        # A task that a person marks has no points yet, but may have passed its checks.
        if result["score"] >= result["of"] or (last is not None and last.passed):
            done.append(task)
    file = last_packed_submission(state, f"{week.name}_exercise") if packed else None
    source = Path(file.source) if file else None
    return Progress(
        done=tuple(done),
        open=tuple(task for task in results if task not in done),
        points=sum(result["score"] for result in results.values()),
        packed=datetime.fromisoformat(packed) if packed else None,
        file=file,
        has_changed=bool(file and source and source.is_file() and content_hash(source) != file.notebook),
    )


def contents_page(state: State) -> str:
    """Return the contents page as Markdown. Its links open inside JupyterLab."""
    rows = list[str]()
    for week in read_weeks():
        following = [path for path in reviews() if path.name.startswith(week.name)]
        deadline = week.settings.deadline
        cells = (
            f"[{week.title}]({week.lesson})",
            f"{week.minutes}",
            f"[{week.exercise}]({week.exercise})" if week.exercise else "",
            FAULTY if week.is_faulty else f"{deadline:%d %B %Y, %H:%M}" if deadline else "",
            progress(week, state).task_count,
        )
        rows += [f"| {' | '.join(cells)} |", *map(_plain_row, following)]
    return PAGE.format(rows="\n".join([*rows, *map(_plain_row, extras())]))


def _plain_row(path: Path) -> str:
    """Return the row of a notebook without an exercise."""
    notebook = read_notebook(path)
    return f"| [{_title(notebook)}]({path.name}) | {notebook['metadata']['course']['minutes']} | | | |"


def write_contents(folder: Path) -> Path:
    """Write the contents page into the student's folder."""
    path = folder / CONTENTS_FILE
    write_atomically(path, contents_page(State(folder)).encode())
    return path


def status(folder: Path | None = None, now: datetime | None = None) -> tuple[Table, str]:
    """Return a table of the weeks, and lines about the packed files and the next step.

    Args:
        folder: The student's folder; by default the one around the working directory or
            ./my_course.
        now: The current time, for tests.

    Raises:
        CourseError: The student's folder does not exist.
    """
    root = find_student_folder(folder) or find_student_folder(folder or DEFAULT_FOLDER)
    if root is None:
        place = folder or Path.cwd()
        raise CourseError(f"{place} contains no {DEFAULT_FOLDER}: run course lab first")
    now, zone, state = now or datetime.now(UTC), shipped_course_file().zone, State(root)
    table = Table(*HEADINGS, caption="Points are those of the public checks; grading adds hidden ones.")
    rows = [(week, progress(week, state)) for week in read_weeks()]
    for week, so_far in rows:
        if week.exercise is None or week.is_faulty:
            table.add_row(week.title, "", "", "", FAULTY if week.exercise else "")
            continue
        points = f"{so_far.points:g} of {sum(week.settings.points.values()):g}"
        packed_at = f"{so_far.packed.astimezone(zone):%d %b %H:%M}" if so_far.packed else "not yet"
        due = _due(week.settings.deadline, now, zone)
        table.add_row(week.title, so_far.task_count, points, packed_at, due)
    packed_lines = [_describe_zip(week, so_far) for week, so_far in rows if so_far.packed]
    return table, "\n".join([*packed_lines, _next(rows)])


def _due(deadline: datetime | None, now: datetime, zone: ZoneInfo) -> str:
    """Return the deadline in the course's local time, and the time left."""
    if deadline is None:
        return "no deadline"
    remaining_time = deadline.replace(tzinfo=zone) - now
    hours = remaining_time.total_seconds() / 3600
    if hours < 0:
        remaining_text = "over"
    elif hours < HOURS_SHOWN:
        remaining_text = f"{hours:.0f} h left"
    else:
        remaining_text = f"{remaining_time.days} days left"
    return f"{deadline:%d %b %H:%M}, {remaining_text}"


def _describe_zip(week: Week, so_far: Progress) -> str:
    """Describe the last packed file, and whether it matches the notebook."""
    file = so_far.file
    if file is None:
        return f"{week.exercise}: packed by an older version, which did not record its contents."
    path, source = Path(file.file), Path(file.source).name
    outcomes = "; ".join(f"{outcome}: {', '.join(names)}" for outcome, names in file.by_outcome.items())
    sentences = [
        f"{path.name} holds {format_count(len(file.tasks), 'task')} of {source}, when packed {outcomes}."
    ]
    if not path.is_file():
        sentences.append(f"It is no longer at {path}.")
    if so_far.has_changed:
        sentences.append(f"{source} has changed since: course submit {source}")
    return " ".join(sentences)


def _next(rows: list[tuple[Week, Progress]]) -> str:
    """Return a sentence with the next step."""
    for week, so_far in rows:
        if so_far.open:
            verb = "go on with" if so_far.done else "begin with"
            return f"Next: {verb} {so_far.open[0]} in {week.exercise}; the lesson is {week.lesson}."
        if week.exercise and so_far.has_changed:
            return f"Next: hand in {week.name} again, it has changed: course submit {week.exercise}"
        if week.exercise and so_far.packed is None:
            return f"Next: hand in {week.name}: course submit {week.exercise}"
    return "All exercises are done and packed."
