"""The first page of the student's folder: every week, how long it takes, and how far one got."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from course_lib.course.checked import Packed, last_check, last_packed
from course_lib.course.course_file import Week as Settings
from course_lib.course.course_file import shipped_course_file
from course_lib.course.exercise_file import read_notebook, source
from course_lib.course.files import exercises_dir, lessons_dir
from course_lib.course.folder import content_hash
from course_lib.course.state import State
from course_lib.course.whole_file import write_whole

CONTENTS_FILE = "contents.md"
PAGE = """\
# Contents and progress

*Made anew by every `course lab`. Your own notes are safe in any other file.*

| lesson | minutes | exercise | hand in by | public checks passed |
|---|---|---|---|---|
{rows}

Check: `course check week01_exercise.ipynb`. Hand in: `course submit week01_exercise.ipynb`. \
How far you are now: `course status`.
"""


@dataclass(frozen=True)
class Week:
    """One row of the page."""

    name: str  # "week01"
    title: str
    minutes: int  # [min] of the lesson
    lesson: str  # file name
    exercise: str | None  # file name
    settings: Settings  # of course.toml


def load_weeks() -> tuple[Week, ...]:
    """All weeks that have a lesson, in order; deadlines and points from course.toml."""
    settings = shipped_course_file().weeks
    return tuple(_week(path, settings) for path in sorted(lessons_dir().glob("week*.ipynb")))


def _week(lesson: Path, settings: Mapping[str, Settings]) -> Week:
    notebook, name = read_notebook(lesson), lesson.stem.split("_")[0]
    exercise = exercises_dir() / f"{name}_exercise.ipynb"
    return Week(
        name=name,
        title=source(notebook["cells"][0]).splitlines()[0].lstrip("# "),
        minutes=notebook["metadata"]["course"]["minutes"],
        lesson=lesson.name,
        exercise=exercise.name if exercise.exists() else None,
        settings=settings.get(name, Settings("")),
    )


@dataclass(frozen=True)
class Progress:
    """How far the public checks of a week are passed, and what was packed to hand in."""

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
    """Whether a task has its points; one that a person marks: whether it passed its checks."""
    last = last_check(state, task)
    return result["score"] >= result["of"] or (last is not None and last.passed)


def _has_changed(file: Packed) -> bool:
    source = Path(file.source)
    return source.is_file() and content_hash(source) != file.notebook


def contents_page(state: State) -> str:
    """The page as Markdown; links open inside JupyterLab."""
    return PAGE.format(rows="\n".join(_row(week, state) for week in load_weeks()))


def _row(week: Week, state: State) -> str:
    deadline = week.settings.deadline
    cells = (
        f"[{week.title}]({week.lesson})",
        f"{week.minutes}",
        f"[{week.exercise}]({week.exercise})" if week.exercise else "",
        f"{deadline:%d %B %Y, %H:%M}" if deadline else "",
        progress(week, state).tasks,
    )
    return f"| {' | '.join(cells)} |"


def write_contents(folder: Path) -> Path:
    """Write the page into the student's folder."""
    path = folder / CONTENTS_FILE
    write_whole(path, contents_page(State(folder)).encode())
    return path
