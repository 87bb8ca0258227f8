"""The student's folder: its files, which students edit.

`prepare` therefore stores a hash of each shipped file: it updates a file only if the student has not
changed it, and otherwise writes the new version next to it.
"""

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path

from course_lib.course.exercise import read_notebook, source, stamp_exercises
from course_lib.course.material import (
    ASSETS,
    PACKAGE,
    asset_files,
    course_package,
    exercises_dir,
    lessons_dir,
)
from course_lib.course.state import STATE_FOLDER, WRITTEN_FOLDER, State
from course_lib.errors import CourseError
from course_lib.files import write_atomically
from course_lib.third_party import read_bytes

DEFAULT_FOLDER = Path("my_course")
# Folder of released solutions, in exercises/ of the students' copy and in a student's folder.
SOLUTIONS = "solutions"
# Other files in notebooks/ were written by lessons.
LESSONS = ("week*.ipynb", "extra_*.ipynb", "week*.py")


@dataclass(frozen=True)
class Refresh:
    """The changes made by a call of `prepare`, as names relative to the folder."""

    added: tuple[str, ...] = ()
    # Files that the student has not edited, so they were replaced by the new release.
    updated: tuple[str, ...] = ()
    # Files that the student has edited, so the new version was written next to each of them.
    kept: tuple[str, ...] = ()

    def lines(self) -> list[str]:
        """Return the report, a line per kind of change."""
        return [
            f"{label}: {', '.join(names)}"
            for label, names in (
                ("new", self.added),
                ("updated", self.updated),
                ("you edited these, so the new version is next to yours", self.kept),
            )
            if names
        ]


def shipped_files() -> dict[str, Path]:
    """Return the kit's file for each name in a student's folder."""
    lessons = [path for pattern in LESSONS for path in lessons_dir().glob(pattern)]
    notebooks = [*lessons, *exercises_dir().glob("week*.ipynb")]
    assets = asset_files(exercises_dir() / ASSETS)
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
    added, updated, kept = [], [], []
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
                endings = (f"_new{number}{own_file.suffix}" for number in ("", *range(2, 1000)))
                places = (own_file.with_name(f"{own_file.stem}{ending}") for ending in endings)
                place = next((place for place in places if not place.exists()), None)
                if place is None:
                    raise CourseError(
                        f"too many newer versions next to {own_file}: delete the ones you don't need"
                    )
                kept.append(place.name)
                _write(newest, place)
        state.put("shipped", name, release)
    return Refresh(tuple(added), tuple(updated), tuple(kept))


def _write(source: Path, target: Path) -> None:
    # A partial file would count as one that the student has edited.
    write_atomically(target, read_bytes(source))
