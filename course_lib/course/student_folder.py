"""The student's folder: its files, the page of contents and progress, and JupyterLab.

Students edit the files that they get. `prepare` therefore stores a hash of each shipped file: it
updates a file only if the student has not changed it, and otherwise writes the new version next to
it.
"""

import hashlib
import json
import os
import re
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import sysconfig
import time
import tomllib
import webbrowser
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from fnmatch import fnmatch
from pathlib import Path
from zoneinfo import ZoneInfo

import psutil
from rich.table import Table

from course_lib.course.course_file import CourseFile, WeekSettings, read_course_file, shipped_course_file
from course_lib.course.exercise import (
    BEGIN,
    END,
    Notebook,
    read_notebook,
    source,
    stamp_exercises,
    write_exercises,
)
from course_lib.course.state import (
    PACKAGE,
    STATE_FOLDER,
    WRITTEN_FOLDER,
    PackedSubmission,
    State,
    checkout_root,
    course_package,
    exercises_dir,
    extras,
    find_student_folder,
    last_check,
    last_packed_submission,
    lessons,
    lessons_dir,
    reviews,
    solutions_dir,
)
from course_lib.errors import CourseError, format_count
from course_lib.files import draft_folder, write_atomically
from course_lib.host import hub_prefix
from course_lib.third_party import read_bytes, read_json, read_text

README, README_STUDENTS = "README.md", "README_students.md"
FOR_STUDENTS = """# {title}

You need Python 3.11 or newer, and `course_lib`, which your instructor tells you how to install. Type in this
folder, in a new virtual environment:

```console
pip install -e . && course lab
```

JupyterLab opens in your browser and shows your own folder `my_course`, with the lessons and exercises.

```console
course status                    # your progress and the next step
course check week01_exercise     # the public checks of an exercise
course submit week01_exercise    # one file to hand in; warns of what is unfinished
```
"""
DEFAULT_FOLDER = Path("my_course")
# Folder of released solutions, in exercises/ of the students' copy and in a student's folder.
SOLUTIONS = "solutions"
# Files that are released in addition to the course's package. solutions/, tests/ (with right and
# wrong answers) and hidden checks are only for instructors.
RELEASED = (
    "notebooks",
    "exercises",
    ".binder",
    ".devcontainer",
    # Pictures of the kit's README.md.
    "docs/images",
    "pyproject.toml",
    "LICENSE",
    "CHANGELOG.md",
)
# Extensions and groups are private, so these tables are removed for students.
EXTENSIONS = re.compile(r"^\[(?:weeks\.\w+\.extensions|groups)\].*?(?=^\[|\Z)", re.MULTILINE | re.DOTALL)
LEFT_OUT = shutil.ignore_patterns("__pycache__", "*.pyc", ".*", "_course")
# Other files in notebooks/ were written by lessons.
LESSONS = ("week*.ipynb", "extra_*.ipynb", "week*.py")


@dataclass(frozen=True)
class Refresh:
    """The changes made by a call of `prepare`, as names relative to the folder."""

    added: tuple[str, ...] = ()
    # Files that the student has not edited, so they were replaced by the new release.
    updated: tuple[str, ...] = ()
    # Files that the student has edited, so the new version was written next to each of them.
    beside: tuple[str, ...] = ()

    def lines(self) -> list[str]:
        """Return the report, a line per kind of change."""
        return [
            f"{label}: {', '.join(names)}"
            for label, names in (
                ("new", self.added),
                ("updated", self.updated),
                ("you edited these, so the new version is next to yours", self.beside),
            )
            if names
        ]


def shipped_files() -> dict[str, Path]:
    """Return the kit's file for each name in a student's folder."""
    lessons = [
        path for name in ("week*.ipynb", "week*.py", "extra_*.ipynb") for path in lessons_dir().glob(name)
    ]
    notebooks = [*lessons, *exercises_dir().glob("week*.ipynb")]
    assets = [path for path in (exercises_dir() / "assets").rglob("*") if path.is_file()]
    by_name = {path.name: path for path in notebooks}
    released = (exercises_dir() / SOLUTIONS).glob("*.ipynb")
    in_folders = {path.relative_to(exercises_dir()).as_posix(): path for path in (*assets, *released)}
    return dict(sorted((by_name | in_folders).items()))


def content_hash(path: Path) -> str:
    """Return a digest of a notebook's cells without outputs, or of any other file's bytes."""
    content = read_bytes(path)
    if path.suffix == ".ipynb":
        try:
            cells = [(cell.get("cell_type"), source(cell)) for cell in read_notebook(path)["cells"]]
            content = json.dumps(cells).encode()
        except CourseError:
            # The student has damaged the file, so its bytes differ from every shipped version.
            pass
    return hashlib.sha256(content).hexdigest()


def prepare(folder: Path) -> Refresh:
    """Copy missing files and newer versions into the student's folder, next to edited files.

    Raises:
        CourseError: The folder is a file or the kit's own checkout, or cannot be written.
    """
    folder = folder.expanduser().resolve()
    if folder.exists() and not folder.is_dir():
        raise CourseError(f"{folder} is a file, not a folder. Choose another one: course lab my_course")
    if folder in (PACKAGE.parent, course_package().parent):
        raise CourseError(f"{folder} is the kit's own folder. Choose another one: course lab my_course")
    try:
        for name in (STATE_FOLDER, WRITTEN_FOLDER):
            (folder / name).mkdir(parents=True, exist_ok=True)
        refresh = _refresh(folder)
    except OSError as error:
        raise CourseError(
            f"can't write into {folder} ({error.strerror}). Try: course lab ~/course"
        ) from error
    state = State(folder)
    student = state.get("identity", "student")
    if student:
        stamp_exercises(folder, student)
    return refresh


def _refresh(folder: Path) -> Refresh:
    state = State(folder)
    shipped = state.section("shipped")
    added, updated, beside = [], [], []
    for name, newest in shipped_files().items():
        own_file, release = folder / name, content_hash(newest)
        if not own_file.exists():
            added.append(name)
            _write(newest, own_file)
        elif shipped.get(name) != release and (now := content_hash(own_file)) != release:
            if now == shipped.get(name):
                updated.append(name)
                _write(newest, own_file)
            else:
                place = _free_name(own_file)
                beside.append(place.name)
                _write(newest, place)
        state.put("shipped", name, release)
    return Refresh(tuple(added), tuple(updated), tuple(beside))


def _write(newest: Path, place: Path) -> None:
    # A partial file would count as one that the student has edited.
    write_atomically(place, read_bytes(newest))


def _free_name(path: Path) -> Path:
    for number in range(1, 1000):
        place = path.with_name(f"{path.stem}_new{number if number > 1 else ''}{path.suffix}")
        if not place.exists():
            return place
    raise CourseError(f"too many newer versions next to {path}: delete the ones you don't need")


def _released_names() -> tuple[str, ...]:
    return (course_package().name, *RELEASED)


def free_folder(out: Path) -> Path:
    """Return the folder for a release.

    Raises:
        CourseError: It is not empty or is inside a folder that is released.
    """
    root, out = checkout_root(), out.expanduser().resolve()
    if out.exists() and (not out.is_dir() or any(out.iterdir())):
        raise CourseError(
            f"{out} is not an empty folder. Choose a folder that does not exist yet, or remove this one."
        )
    if any(out.is_relative_to(root / name) for name in _released_names()):
        raise CourseError(f"{out} is inside the released files. Choose a folder elsewhere.")
    return out


def require_closed(weeks: Iterable[str]) -> None:
    """Raise a CourseError if points of a week can still be earned, so its solution must remain hidden."""
    course = shipped_course_file()
    for week in weeks:
        closing = course.closing_time(week)
        if datetime.now(UTC) < closing:
            local = closing.astimezone(course.zone)
            raise CourseError(
                f"{week} can be handed in for points until {local:%Y-%m-%d %H:%M}, with extensions "
                "and late days: release its solution after that"
            )
        if not _solution(week).is_file():
            raise CourseError(f"{week} has no solution: there is no {_solution(week)}")


def _solution(week: str) -> Path:
    return solutions_dir() / f"{week}_solution.ipynb"


def release(out: Path, solved: Sequence[str] = ()) -> list[Path]:
    """Copy the files for students into `out` and return their paths.

    Args:
        out: An empty or new folder.
        solved: The weeks whose solution is released, too, like "week01".

    Raises:
        CourseError: This is not a checkout, `out` is not empty or cannot be written, or course.toml
            is malformed. A week in `solved` can still be handed in for points.
    """
    root, out = checkout_root(), free_folder(out)
    require_closed(solved)
    renew_exercises()
    settings = _without_extensions(root / "exercises" / "course.toml")
    try:
        # The draft lies inside of `out`, which may be a file system of its own. A release that is
        # interrupted leaves no folder that looks complete.
        with draft_folder(out / "release") as draft:
            names = [name for name in _released_names() if (root / name).exists()]
            copies = [_copy(root / name, draft / name) for name in names]
            (draft / "exercises" / "course.toml").write_text(settings, encoding="utf-8")
            copies += [_copy_solution(week, draft / "exercises" / SOLUTIONS) for week in solved]
            (draft / "README.md").write_text(_readme(root), encoding="utf-8")
            for path in list(draft.iterdir()):
                path.replace(out / path.name)
            return [out / path.relative_to(draft) for path in [*copies, draft / "README.md"]]
    except OSError as error:
        raise CourseError(
            f"can't write the release to {out}: {error.strerror}. Choose another folder."
        ) from error


def _copy_solution(week: str, folder: Path) -> Path:
    """Write a week's solution without the comments that mark the answers, and return its path."""
    notebook = read_notebook(_solution(week))
    for cell in notebook["cells"]:
        lines = source(cell).splitlines(keepends=True)
        cell["source"] = [line for line in lines if not BEGIN.match(line.rstrip()) and line.strip() != END]
    folder.mkdir(parents=True, exist_ok=True)
    place = folder / f"{week}_solution.ipynb"
    place.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    return place


def renew_exercises() -> None:
    """Write the exercises from the solutions. Unlike verification, this takes no noticeable time.

    Raises:
        CourseError: One of them has changed, and somebody must look at it; or a solution has a
        wrong marker.
    """
    if stale := write_exercises():
        names = ", ".join(path.name for path in stale)
        raise CourseError(f"updated from the solutions: {names}. Review and commit them, then release again.")


def _readme(root: Path) -> str:
    """Return the README of the students' copy: README_students.md, or a short introduction.

    The README of a course's checkout is for authors. The README of the kit is also for students.
    """
    readme = root / (README if course_package() == PACKAGE else README_STUDENTS)
    if readme.is_file():
        return read_text(readme)
    title = read_course_file(root / "exercises" / "course.toml").title
    return FOR_STUDENTS.format(title=title or "Your course")


def _without_extensions(path: Path) -> str:
    """Return course.toml without extensions and groups. Raise a CourseError if it is malformed."""
    read_course_file(path).require_valid()
    text = EXTENSIONS.sub("", read_text(path))
    content = tomllib.loads(text)
    if "groups" in content:
        raise CourseError(f"{path}: write the students' groups as a table, [groups]")
    for week, table in content["weeks"].items():
        if "extensions" in table:
            raise CourseError(f"{path}: write {week}'s extensions as a table, [weeks.{week}.extensions]")
    return text


def _ignored_names(folder: str, names: list[str]) -> set[str]:
    """Return the names for `shutil.copytree` to ignore. notebooks/ may contain files written by lessons."""
    if Path(folder).name != "notebooks":
        return LEFT_OUT(folder, names)
    return {name for name in names if not any(fnmatch(name, pattern) for pattern in LESSONS)}


def _copy(source: Path, place: Path) -> Path:
    place.parent.mkdir(parents=True, exist_ok=True)
    if source.is_dir():
        shutil.copytree(source, place, ignore=_ignored_names if source.name == "notebooks" else LEFT_OUT)
    else:
        shutil.copyfile(source, place)
    return place


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


def load_weeks() -> tuple[Week, ...]:
    """Return all weeks that have a lesson, in order, with deadlines and points from course.toml."""
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

    # Tasks with all points, and the others.
    done: tuple[str, ...]
    open: tuple[str, ...]
    # Points from public checks. Hidden checks are added at grading.
    points: float
    # Time of the last `course submit`.
    packed: datetime | None
    # The packed file, unless an older version of the kit wrote it.
    file: PackedSubmission | None = None
    # Whether the notebook has changed since then.
    changed: bool = False

    @property
    def tasks(self) -> str:
        """The number of finished tasks, like "2 of 4 tasks"; "" without tasks."""
        count = len(self.done) + len(self.open)
        return f"{len(self.done)} of {count} tasks" if count else ""


def progress(week: Week, state: State) -> Progress:
    """Return the stored results and submissions of a week."""
    saved_results, packed = state.section("progress"), state.get("packed", f"{week.name}_exercise")
    none = {"score": 0.0, "of": 1.0}
    results = {task: saved_results.get(f"{week.name}.{task}", none) for task in week.settings.points}
    done = tuple(t for t, result in results.items() if _is_done(state, f"{week.name}.{t}", result))
    file = last_packed_submission(state, f"{week.name}_exercise") if packed else None
    source = Path(file.source) if file else None
    return Progress(
        done=done,
        open=tuple(task for task in results if task not in done),
        points=sum(result["score"] for result in results.values()),
        packed=datetime.fromisoformat(packed) if packed else None,
        file=file,
        changed=bool(file and source and source.is_file() and content_hash(source) != file.notebook),
    )


def _is_done(state: State, task: str, result: Mapping[str, float]) -> bool:
    """Return whether a task has all its points or, if a person marks it, has passed its checks."""
    last = last_check(state, task)
    return result["score"] >= result["of"] or (last is not None and last.passed)


def contents_page(state: State) -> str:
    """Return the contents page as Markdown. Its links open inside JupyterLab."""
    rows = list[str]()
    for week in load_weeks():
        following = [path for path in reviews() if path.name.startswith(week.name)]
        rows += [_row(week, state), *map(_plain_row, following)]
    return PAGE.format(rows="\n".join([*rows, *map(_plain_row, extras())]))


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
    rows = [(week, progress(week, state)) for week in load_weeks()]
    for week, so_far in rows:
        table.add_row(*_cells(week, so_far, now, zone))
    packed_lines = [_describe_packed(week, so_far) for week, so_far in rows if so_far.packed]
    return table, "\n".join([*packed_lines, _next(rows)])


def _cells(week: Week, so_far: Progress, now: datetime, zone: ZoneInfo) -> tuple[str, ...]:
    if week.exercise is None:
        return (week.title, "", "", "", "")
    if week.is_faulty:
        return (week.title, "", "", "", FAULTY)
    points = f"{so_far.points:g} of {sum(week.settings.points.values()):g}"
    packed_at = f"{so_far.packed.astimezone(zone):%d %b %H:%M}" if so_far.packed else "not yet"
    return (week.title, so_far.tasks, points, packed_at, _due(week.settings.deadline, now, zone))


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


def _describe_packed(week: Week, so_far: Progress) -> str:
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
    if so_far.changed:
        sentences.append(f"{source} has changed since: course submit {source}")
    return " ".join(sentences)


def _next(rows: list[tuple[Week, Progress]]) -> str:
    """Return a sentence with the next step."""
    for week, so_far in rows:
        if so_far.open:
            verb = "go on with" if so_far.done else "begin with"
            return f"Next: {verb} {so_far.open[0]} in {week.exercise}; the lesson is {week.lesson}."
        if week.exercise and so_far.changed:
            return f"Next: hand in {week.name} again, it has changed: course submit {week.exercise}"
        if week.exercise and so_far.packed is None:
            return f"Next: hand in {week.name}: course submit {week.exercise}"
    return "All exercises are done and packed."


FIRST_PORT = 8888
PORTS_TO_TRY = 100
# Time limit [s]. A first start compiles Python files, perhaps on a slow disk.
START_SECONDS = 180.0
# These settings disable pop-ups about news, and open Markdown files as rendered pages.
JUPYTER_SETTINGS = Path(__file__).parent / "jupyter"
# JupyterLab finds the extension of an installed wheel automatically, but not in a checkout.
LAB_EXTENSIONS = JUPYTER_SETTINGS / "labextensions"
KERNEL_STARTUP = JUPYTER_SETTINGS / "kernel_startup.py"


def free_port(first: int = FIRST_PORT) -> int:
    """Return the first free port at or above `first`.

    Raises:
        CourseError: No port is free, or the number is not a port.
    """
    if not 1 <= first <= 65535:
        raise CourseError(f"--port {first}: a port is a number from 1 to 65535. Try: course lab --port 8888")
    for port in range(first, min(first + PORTS_TO_TRY, 65536)):
        with socket.socket() as probe, suppress(OSError):
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(("127.0.0.1", port))
            return port
    raise CourseError(f"no free port from {first} on. Choose another one: course lab --port 9500")


def command(folder: Path, port: int) -> list[str]:
    """Return the command that starts the server for this folder only, without pop-ups."""
    allow_root = ["--allow-root"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
    return [
        *(sys.executable, "-P", "-m", "course_lib.course.jupyterlab", "--no-browser", *allow_root),
        f"--ServerApp.root_dir={folder}",
        f"--ServerApp.port={port}",
        # Stop at the first Ctrl+C, without asking.
        "--ServerApp.answer_yes=True",
        "--ServerApp.log_level=ERROR",
        "--LabApp.log_level=ERROR",
        f"--LabApp.extra_labextensions_path={LAB_EXTENSIONS}",
        f"--LabApp.default_url=/lab/tree/{CONTENTS_FILE}",
        "--LabApp.check_for_updates_class=jupyterlab.NeverCheckForUpdate",
    ]


@contextmanager
def server(folder: Path, port: int) -> Iterator[tuple["subprocess.Popen[bytes]", str]]:
    """Start JupyterLab, yield its process and address, and stop it at the end of the block."""
    process, address = _start_jupyterlab(folder, port)
    try:
        yield process, address
    finally:
        _stop(process)


def _start_jupyterlab(folder: Path, port: int) -> tuple["subprocess.Popen[bytes]", str]:
    """Start JupyterLab on a port, or on another one if the port has been taken in the meantime."""
    token = secrets.token_hex(24)
    settings = [str(JUPYTER_SETTINGS), *filter(None, [os.environ.get("JUPYTER_CONFIG_PATH")])]
    paths = [sysconfig.get_path("scripts"), *filter(None, [os.environ.get("PATH")])]
    environment = {
        # JupyterLab's terminals find `course` even if no virtual environment was activated.
        "PATH": os.pathsep.join(paths),
        "JUPYTER_TOKEN": token,
        "JUPYTER_CONFIG_PATH": os.pathsep.join(settings),
        # For the kernels: the order of sets is the same in every run, as in grading.
        "PYTHONHASHSEED": "0",
        "PYTHONSTARTUP": os.environ.get("PYTHONSTARTUP") or str(KERNEL_STARTUP),
    }
    process = subprocess.Popen(
        command(folder, port), env=os.environ | environment, cwd=folder, stdin=subprocess.DEVNULL
    )
    try:
        url = _wait_for_server_url(process)
    # Includes Ctrl+C.
    except BaseException:
        _stop(process)
        raise
    if url is not None:
        return process, f"{url}lab/tree/{CONTENTS_FILE}?token={token}"
    other = free_port(port)
    if process.poll() is None or other == port:
        _stop(process)
        raise CourseError("JupyterLab did not start; see its message above. Try: python -m jupyterlab")
    say(f"Another program has taken port {port} in the meantime. Using port {other}.")
    return _start_jupyterlab(folder, other)


def _stop(process: "subprocess.Popen[bytes]") -> None:
    # The server shuts down its kernels before it exits.
    process.terminate()
    try:
        process.wait(timeout=10)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def _wait_for_server_url(process: "subprocess.Popen[bytes]") -> str | None:
    """Return the URL of the server, or None if it has ended or does not listen in time.

    Jupyter writes the URL into a file before it listens, so another program can take the port in
    between.
    """
    from jupyter_core.paths import jupyter_runtime_dir

    facts = Path(jupyter_runtime_dir()) / f"jpserver-{process.pid}.json"
    deadline = time.monotonic() + START_SECONDS
    while process.poll() is None and time.monotonic() < deadline:
        # The file may be missing or incomplete, or the process may have just ended.
        with suppress(OSError, ValueError, psutil.Error):
            url = str(read_json(facts.read_text())["url"])
            sockets = psutil.Process(process.pid).net_connections("tcp")
            if any(connection.status == psutil.CONN_LISTEN for connection in sockets):
                return url
        time.sleep(0.1)
    return None


def provide_home(folder: Path) -> list[str]:
    """Set HOME to a folder in the student's folder if the user has no home folder that can be written.

    JupyterLab and IPython do not start without one, which some containers and hubs lack.

    Returns:
        A line for the student if HOME was set.
    """
    home = os.path.expanduser("~")  # "~" itself if the user has none
    if os.access(home, os.W_OK):
        return []
    own = folder / STATE_FOLDER / "home"
    own.mkdir(parents=True, exist_ok=True)
    os.environ["HOME"] = str(own)
    return [f"Your home folder {home} cannot be written, so Jupyter's settings are in {own}."]


def can_open_browser() -> bool:
    """Return whether a graphical browser can be opened.

    A text browser would occupy the terminal.
    """
    if sys.platform.startswith("linux") and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        return False
    with suppress(webbrowser.Error):
        webbrowser.get()
        return True
    return False


def lab(
    folder: Path = DEFAULT_FOLDER,
    *,
    port: int | None = None,
    browser: bool = True,
    serves: bool = True,
) -> None:
    """Update the student's folder and serve it until Ctrl+C, or SIGTERM when a container stops.

    On a JupyterHub, or without `serves`, only the folder is updated, because JupyterLab already
    runs.

    Raises:
        CourseError: The folder or the port cannot be used, or JupyterLab did not start.
    """
    folder = folder.expanduser().resolve()
    report = prepare(folder).lines()
    write_contents(folder)
    if hub_prefix() or not serves:
        next_step = f"Open {CONTENTS_FILE} of it in JupyterLab."
        say("\n".join([f"Your course folder: {folder}", *report, next_step]))
    else:
        server_port = free_port(FIRST_PORT if port is None else port)
        if port not in (None, server_port):
            report.append(f"Port {port} is taken, using {server_port}.")
        report += provide_home(folder)
        say("\n".join([f"Your course folder: {folder}", *report, "Starting JupyterLab …"]))
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        try:
            with server(folder, server_port) as (process, address):
                say(f"Open this address in a browser:\n\n    {address}\n\nStop with Ctrl+C.")
                if browser and can_open_browser():
                    webbrowser.open(address)
                process.wait()
        except KeyboardInterrupt:
            say("\nJupyterLab is stopped. Your files are kept.")


def say(text: str) -> None:
    """Print a message and flush it, so that it also appears when the output is a pipe."""
    print(text, flush=True)  # noqa: T201  the command's own voice
