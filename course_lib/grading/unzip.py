"""Archives from students, opened and read within limits that do not depend on what they claim."""

import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO

from course_lib.errors import CourseError

MAX_MEMBERS = 1000  # of one archive
MAX_ENTRIES = 20 * MAX_MEMBERS  # archives that are stored in it have directories of their own
ENTRY = b"PK\x01\x02"  # begins each entry of an archive's directory
METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # zipfile unpacks the others without a limit


@contextmanager
def opened_zip(data: bytes) -> Iterator[zipfile.ZipFile]:
    """Open an archive; its directory is parsed only if it is short.

    Raises:
        CourseError: It is not a zip, is damaged, or has more than MAX_MEMBERS files.
    """
    _demand_few(data.count(ENTRY), MAX_ENTRIES)
    try:
        archive = zipfile.ZipFile(BytesIO(data))
    except Exception as error:  # a broken archive raises a dozen kinds
        raise CourseError(f"it is not a zip that can be read: {error}") from error
    with archive:
        _demand_few(len(archive.infolist()), MAX_MEMBERS)
        yield archive


def read_member(archive: zipfile.ZipFile, member: zipfile.ZipInfo | str, most: int) -> bytes:
    """Unpack one file, no further than one byte beyond `most`, whatever size the archive claims.

    Raises:
        CourseError: There is no such file, it is locked or damaged, or needs another way of unpacking.
    """
    try:
        info = archive.getinfo(member) if isinstance(member, str) else member
        if info.compress_type not in METHODS:
            raise ValueError(f"compression method {info.compress_type}, expected stored or deflated")
        with archive.open(info) as file:
            return file.read(most + 1)
    except Exception as error:  # a broken or locked archive raises a dozen kinds
        raise CourseError(f"can't be unpacked: {error}") from error


def _demand_few(count: int, most: int) -> None:
    if count > most:
        raise CourseError(f"it has {count} files, expected at most {MAX_MEMBERS}")
