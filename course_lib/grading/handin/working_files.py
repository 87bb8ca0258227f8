"""Files that a notebook names and that lie beside it: layouts, parameters, launch files."""

import re
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path, PurePosixPath

from course_lib.errors import CourseError
from course_lib.grading.handin.archives import opened_zip, read_member

SUFFIXES = (".rviz", ".yaml", ".yml", ".xml", ".urdf", ".py")
FOLDER = "files/"  # in what `course submit` writes
MAX_BYTES = 1_000_000  # of each
MAX_FILES = 20
MAX_NAMES = 1000  # that are looked for
_QUOTED = re.compile(r"""["']([^"'\n]{1,200})["']""")


def working_files(path: Path, cells: Sequence[str]) -> dict[str, str]:
    """Return the texts of the files with a handed-in notebook, by their paths from its folder.

    Raises:
        CourseError: They can't be read.
    """
    found = _packed(path) if path.suffix.lower() == ".zip" else _beside(path.parent, cells)
    files: dict[str, str] = {}
    try:
        for name, data in found:
            text = data.decode("utf-8", "replace")  # may be three times as long then
            if len(files) < MAX_FILES and len(text.encode()) <= MAX_BYTES:
                files[name] = text
    except (OSError, CourseError) as error:
        raise CourseError(f"{path.name}: the files with the notebook can't be read: {error}") from error
    return files


def _beside(folder: Path, cells: Sequence[str]) -> Iterator[tuple[str, bytes]]:
    """Yield the files of the folder that the cells name between quotes."""
    home = folder.resolve()
    named = (name for cell in cells for name in _QUOTED.findall(cell) if _is_fine(name))
    for name in dict.fromkeys(islice(named, MAX_NAMES)):
        place = home / name
        if place.is_file() and place.resolve() == place:  # no link leads elsewhere
            with place.open("rb") as file:
                yield name, file.read(MAX_BYTES + 1)


def _packed(path: Path) -> Iterator[tuple[str, bytes]]:
    with opened_zip(path.read_bytes()) as archive:
        for info in archive.infolist()[: 2 * MAX_FILES]:
            name = info.filename.removeprefix(FOLDER)
            if name != info.filename and _is_fine(name):
                yield name, read_member(archive, info, MAX_BYTES)


def _is_fine(name: str) -> bool:
    if not name.lower().endswith(SUFFIXES):
        return False
    path = PurePosixPath(name)
    inside = not path.is_absolute() and ".." not in path.parts and "\\" not in name and name.isprintable()
    return inside and path.suffix != ""
