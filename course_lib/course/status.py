"""`course status`: how far a student is, and what comes next."""

from datetime import UTC, datetime
from pathlib import Path
from zoneinfo import ZoneInfo

from rich.table import Table

from course_lib.course.contents import Progress, Week, load_weeks, progress
from course_lib.course.course_file import shipped_course_file
from course_lib.course.folder import DEFAULT_FOLDER
from course_lib.course.state import State, find_student_folder
from course_lib.errors import CourseError, counted

HEADINGS = ("week", "public checks", "points", "packed", "hand in by")
HOURS_SHOWN = 72  # a deadline nearer than this is told in hours


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
    points = f"{so_far.points:g} of {sum(week.settings.points.values()):g}"
    packed = f"{so_far.packed.astimezone(zone):%d %b %H:%M}" if so_far.packed else "not yet"
    return (week.title, so_far.tasks, points, packed, _due(week.settings.deadline, now, zone))


def _due(deadline: datetime | None, now: datetime, zone: ZoneInfo) -> str:
    """When, and how long from now; a deadline is local time of the course."""
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
    """The first thing that is not done."""
    for week, so_far in rows:
        if so_far.open:
            begun = "go on with" if so_far.done else "begin with"
            return f"Next: {begun} {so_far.open[0]} in {week.exercise}; the lesson is {week.lesson}."
        if week.exercise and so_far.changed:
            return f"Next: hand in {week.name} again, it has changed: course submit {week.exercise}"
        if week.exercise and so_far.packed is None:
            return f"Next: hand in {week.name}: course submit {week.exercise}"
    return "All exercises are done and packed."
