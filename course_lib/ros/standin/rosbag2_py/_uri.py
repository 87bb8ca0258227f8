"""Bags by the names that programs have for them: a folder, or the one file in it."""

from pathlib import Path

from course_lib.errors import CourseError
from course_lib.recording import Recording, read_bag
from course_lib.recording.salvage import data_files
from rosbag2_py._storage import BagError


def folder_of(uri: str) -> Path:
    """Return a bag's folder; programs name the one file in it as well.

    Raises:
        BagError: The file is one of several.
    """
    path = Path(uri)
    if path.suffix not in (".mcap", ".db3") or not path.is_file():
        return path
    if data_files(path.parent) != [path]:
        raise BagError(f"{path} is one of several files. Open the bag's folder: {path.parent}.")
    return path.parent


def whole(uri: str) -> Recording:
    """Read a bag; raises a BagError where there is none."""
    try:
        return read_bag(folder_of(uri))
    except CourseError as error:
        raise BagError(str(error)) from None
