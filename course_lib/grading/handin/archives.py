"""Files with a submission and in a platform's download, read within limits and without trust."""

import os
import re
import stat
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from io import BytesIO
from itertools import islice
from pathlib import Path, PurePosixPath

from course_lib.errors import CourseError
from course_lib.grading.handin.notebook import MAX_BYTES

MAX_MEMBERS = 1000  # of one archive
MAX_ENTRIES = 20 * MAX_MEMBERS  # archives that are stored in it have directories of their own
ENTRY = b"PK\x01\x02"  # begins each entry of an archive's directory
METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # zipfile unpacks the others without a limit
MAX_DEPTH = 3  # of archives in archives
MAX_NAME = 200  # [B] of each part of a path
MAX_PATH = 1000  # [B]
MAX_UNPACKED_FILES = 1000  # of one student, out of all the archives that the student handed in
MAX_UNPACKED_BYTES = 50_000_000  # of the same, archives in archives included
RECEIPT = "receipt.json"  # in a file of `course submit`
JUNK = ("__MACOSX", "Thumbs.db")

Refuse = Callable[[str, str], None]  # gets a file's name, and why
Owner = Callable[[tuple[str, ...]], str]  # of a path: whose archives share a limit
WORKING_SUFFIXES = (".rviz", ".yaml", ".yml", ".xml", ".urdf", ".py")
WORKING_FOLDER = "files/"  # in what `course submit` writes
MAX_WORKING_BYTES = 1_000_000  # of each
MAX_WORKING_FILES = 20
MAX_NAMES = 1000  # that are looked for
_QUOTED = re.compile(r"""["']([^"'\n]{1,200})["']""")


@contextmanager
def opened_zip(data: bytes) -> Iterator[zipfile.ZipFile]:
    """Open an archive; its directory is parsed only if it is short.

    Raises:
        CourseError: It is not a zip, is damaged, or has more than MAX_MEMBERS files.
    """
    _demand_few(data.count(ENTRY), MAX_ENTRIES)
    with _archive(BytesIO(data)) as archive:
        _demand_few(len(archive.infolist()), MAX_MEMBERS)
        yield archive


def _archive(file: Path | BytesIO) -> zipfile.ZipFile:
    try:
        return zipfile.ZipFile(file)
    except Exception as error:  # a broken archive raises a dozen kinds
        raise CourseError(f"it is not a zip that can be read: {error}") from error


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


@dataclass(frozen=True)
class Arrival:
    """A file.

    Args:
        parts: Its path as it was named, archives included.
        data: Its content.
        time: As the file system or the innermost archive has it: whoever wrote that set it.
    """

    parts: tuple[str, ...]
    data: bytes
    time: datetime


@dataclass
class Arrivals:
    """A reader of one folder or zip.

    Args:
        refuse: Called for each file that is left out.
        owner: Whose a path is; the limits on what archives unpack to hold for each owner in total.
    """

    refuse: Refuse
    owner: Owner = lambda parts: parts[0]
    _files: Counter[str] = field(default_factory=Counter)
    _bytes: Counter[str] = field(default_factory=Counter)
    _full: set[str] = field(default_factory=set)

    def read(self, top: Path) -> Iterator[Arrival]:
        """Yield all files of a folder or a zip, also those in zips in it.

        Raises:
            CourseError: `top` is not a folder or a zip.
        """
        if top.is_dir():
            for arrival in self._walk(top):
                yield from self._opened(arrival, 0)
            return
        try:
            archive = _archive(top)
        except CourseError as error:
            raise CourseError(
                f"{top} is not a folder and not a zip: {error.__cause__}. Name what the platform gave."
            ) from error
        with archive:
            for arrival in self._members(archive, ()):
                yield from self._opened(arrival, 1)

    def _walk(self, top: Path) -> Iterator[Arrival]:
        for folder, folders, names in os.walk(top):
            here = Path(folder)
            links = [name for name in folders if (here / name).is_symlink()]
            folders[:] = sorted(name for name in folders if not _is_junk(name))
            for path in (here / name for name in sorted([*names, *links]) if not _is_junk(name)):
                parts = path.relative_to(top).parts
                try:
                    if problem := _bad_path(parts) or _bad_kind(path.lstat().st_mode):
                        self.refuse("/".join(parts), problem)
                        continue
                    with open(os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK), "rb") as file:
                        data = file.read(MAX_BYTES + 1)
                        time = datetime.fromtimestamp(os.fstat(file.fileno()).st_mtime, UTC)
                except OSError as error:
                    self.refuse("/".join(parts), f"can't be read: {error.strerror}")
                else:
                    if self._fits(parts, data):
                        yield Arrival(parts, data, time)

    def _opened(self, arrival: Arrival, depth: int) -> Iterator[Arrival]:
        """Yield the file, or what is in it if it is an archive that `course submit` did not write."""
        if not arrival.parts[-1].lower().endswith(".zip"):
            yield arrival
            return
        try:
            with opened_zip(arrival.data) as archive:
                if RECEIPT in archive.namelist():
                    yield arrival
                elif depth >= MAX_DEPTH:
                    raise CourseError("archives too deep in each other")
                else:
                    for inner in self._members(archive, arrival.parts):
                        yield from self._opened(inner, depth + 1)
        except CourseError as error:
            self.refuse("/".join(arrival.parts), str(error))

    def _members(self, archive: zipfile.ZipFile, above: tuple[str, ...]) -> Iterator[Arrival]:
        known: set[str] = set()
        for info in archive.infolist():
            inner = tuple(info.orig_filename.split("/"))
            if info.filename.endswith("/") or any(map(_is_junk, inner)):
                continue
            parts = (*above, *inner)
            again = "the archive has this name twice" if info.filename in known else ""
            known.add(info.filename)
            if problem := again or _bad_path(inner) or _bad_kind(info.external_attr >> 16):
                self.refuse("/".join(parts), problem)
                continue
            owner = self.owner(parts)
            if owner in self._full:
                continue
            try:
                data = self._unpacked(archive, info, owner, counted=bool(above))
            except CourseError as error:
                self.refuse("/".join(parts), str(error))
                continue
            if self._fits(parts, data):
                yield Arrival(parts, data, _time(info))

    def _unpacked(
        self, archive: zipfile.ZipFile, info: zipfile.ZipInfo, owner: str, *, counted: bool
    ) -> bytes:
        """Unpack a file, within what its owner has left if it is counted: the platform's archive is not.

        Raises:
            CourseError: It can't be unpacked, or the owner has nothing left: the rest is not looked at.
        """
        left = MAX_UNPACKED_BYTES - self._bytes[owner] if counted else MAX_BYTES + 1
        data = read_member(archive, info, min(MAX_BYTES, left))
        self._files[owner] += counted
        self._bytes[owner] += len(data) if counted else 0
        if len(data) > left or self._files[owner] > MAX_UNPACKED_FILES:
            self._full.add(owner)
            raise CourseError(
                f"all archives of {owner} together unpack to more than {MAX_UNPACKED_BYTES} bytes or "
                f"{MAX_UNPACKED_FILES} files: this file and what follows of {owner} is left out"
            )
        return data

    def _fits(self, parts: tuple[str, ...], data: bytes) -> bool:
        if len(data) > MAX_BYTES:
            self.refuse("/".join(parts), f"it has more than {MAX_BYTES} bytes")
        return len(data) <= MAX_BYTES


def _time(info: zipfile.ZipInfo) -> datetime:
    try:
        return datetime(*info.date_time)
    except ValueError:  # month 0, or hour 31
        return datetime(1980, 1, 1)


def _is_junk(name: str) -> bool:
    return name in JUNK or (name.startswith(".") and name != "..")


def _bad_path(parts: tuple[str, ...]) -> str:
    """Return what is wrong with a path, or ""."""
    if sum(len(part.encode("utf-8", "replace")) for part in parts) > MAX_PATH:
        return f"its path is longer than {MAX_PATH} bytes"
    for part in parts:
        if part in ("", "..") or "\\" in part or (len(part) > 1 and part[1] == ":"):
            return "its path leads elsewhere"
        if not part.isprintable() or len(part.encode("utf-8", "replace")) > MAX_NAME:
            return (
                f"its name is longer than {MAX_NAME} bytes" if part.isprintable() else "its name is not text"
            )
    return ""


def _bad_kind(mode: int) -> str:
    """Return why it is not a file, or ""; archives made elsewhere than on Unix do not record the kind."""
    return "" if stat.S_IFMT(mode) in (0, stat.S_IFREG) else "it is a link or a device"


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
            if len(files) < MAX_WORKING_FILES and len(text.encode()) <= MAX_WORKING_BYTES:
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
                yield name, file.read(MAX_WORKING_BYTES + 1)


def _packed(path: Path) -> Iterator[tuple[str, bytes]]:
    with opened_zip(path.read_bytes()) as archive:
        for info in archive.infolist()[: 2 * MAX_WORKING_FILES]:
            name = info.filename.removeprefix(WORKING_FOLDER)
            if name != info.filename and _is_fine(name):
                yield name, read_member(archive, info, MAX_WORKING_BYTES)


def _is_fine(name: str) -> bool:
    if not name.lower().endswith(WORKING_SUFFIXES):
        return False
    path = PurePosixPath(name)
    inside = not path.is_absolute() and ".." not in path.parts and "\\" not in name and name.isprintable()
    return inside and path.suffix != ""
