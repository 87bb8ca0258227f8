"""The files in a folder or a zip from a learning platform, read without trust in any of them."""

import os
import stat
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from io import BytesIO
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.grading.notebook import MAX_BYTES
from course_lib.grading.submission import RECEIPT

MAX_DEPTH = 3  # of archives in archives
MAX_NAME = 200  # [B] of each part of a path
MAX_INNER_FILES = 1000  # of an archive in an archive
MAX_INNER_BYTES = 100_000_000  # of all its files
JUNK = ("__MACOSX", "Thumbs.db")

Refuse = Callable[[str, str], None]  # gets a file's name, and why


@dataclass(frozen=True)
class Arrival:
    """A file: its path as it was named, archives included; its content; its time, local without a zone."""

    parts: tuple[str, ...]
    data: bytes
    time: datetime


def arrivals(top: Path, refuse: Refuse) -> Iterator[Arrival]:
    """All files of a folder or a zip, also those in zips in it; each one that is refused is told.

    Raises:
        CourseError: There is no such folder, or no zip.
    """
    if top.is_dir():
        for path in _walk(top, refuse):
            yield from _opened(path, refuse, 0)
        return
    try:
        with zipfile.ZipFile(top) as archive:
            for arrival in _members(archive, (), None, refuse):
                yield from _opened(arrival, refuse, 1)
    except (OSError, zipfile.BadZipFile) as error:
        raise CourseError(f"{top} is no folder and no zip: {error}. Name what the platform gave.") from error


def _walk(top: Path, refuse: Refuse) -> Iterator[Arrival]:
    for folder, folders, names in os.walk(top):
        here = Path(folder)
        links = [name for name in folders if (here / name).is_symlink()]
        folders[:] = sorted(name for name in folders if not _is_junk(name))
        for path in (here / name for name in sorted([*names, *links]) if not _is_junk(name)):
            parts = path.relative_to(top).parts
            try:
                if problem := _bad_path(parts) or _bad_kind(path.lstat().st_mode):
                    refuse("/".join(parts), problem)
                    continue
                with open(os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK), "rb") as file:
                    data = file.read(MAX_BYTES + 1)
                    time = datetime.fromtimestamp(os.fstat(file.fileno()).st_mtime, UTC)
                if _fits(parts, data, refuse):
                    yield Arrival(parts, data, time)
            except OSError as error:
                refuse("/".join(parts), f"can't be read: {error.strerror}")


def _opened(arrival: Arrival, refuse: Refuse, depth: int) -> Iterator[Arrival]:
    """The file itself, or what is in it if it is an archive that `course submit` did not write."""
    name = "/".join(arrival.parts)
    if not arrival.parts[-1].lower().endswith(".zip"):
        yield arrival
        return
    try:
        with zipfile.ZipFile(BytesIO(arrival.data)) as archive:
            names = archive.namelist()
            if RECEIPT in names:
                yield arrival
            elif depth >= MAX_DEPTH or len(names) > MAX_INNER_FILES:
                refuse(
                    name, "archives too deep in each other" if depth >= MAX_DEPTH else f"{len(names)} files"
                )
            else:
                for inner in _members(archive, arrival.parts, arrival.time, refuse):
                    yield from _opened(inner, refuse, depth + 1)
    except (OSError, ValueError, zipfile.BadZipFile) as error:
        refuse(name, f"is no zip that can be read: {error}")


def _members(
    archive: zipfile.ZipFile, above: tuple[str, ...], time: datetime | None, refuse: Refuse
) -> Iterator[Arrival]:
    """The files of an archive; with the time of the archive that the platform knows, if it has one."""
    room = MAX_INNER_BYTES if above else None
    known: set[str] = set()
    for info in archive.infolist():
        inner = tuple(info.orig_filename.split("/"))
        if info.is_dir() or any(map(_is_junk, inner)):
            continue
        parts = (*above, *inner)
        again = "the archive has this name twice" if info.filename in known else ""
        known.add(info.filename)
        if problem := again or _bad_path(inner) or _bad_kind(info.external_attr >> 16):
            refuse("/".join(parts), problem)
            continue
        try:
            with archive.open(info) as member:
                data = member.read(MAX_BYTES + 1)  # what the archive says of its sizes need not be true
        except Exception as error:  # a broken or locked archive raises a dozen kinds; none is more than "no"
            refuse("/".join(parts), f"can't be unpacked: {error}")
            continue
        room = None if room is None else room - len(data)
        if room is not None and room < 0:
            refuse("/".join(above), f"its files have more than {MAX_INNER_BYTES} bytes")
            return
        if _fits(parts, data, refuse):
            yield Arrival(parts, data, time or _time(info))


def _time(info: zipfile.ZipInfo) -> datetime:
    try:
        return datetime(*info.date_time)
    except ValueError:  # month 0, or hour 31
        return datetime(1980, 1, 1)


def _is_junk(name: str) -> bool:
    return name in JUNK or (name.startswith(".") and name != "..")


def _bad_path(parts: tuple[str, ...]) -> str:
    """What is wrong with a path, or ""."""
    for part in parts:
        if part in ("", "..") or "\\" in part or (len(part) > 1 and part[1] == ":"):
            return "its path leads elsewhere"
        if not part.isprintable() or len(part.encode("utf-8", "replace")) > MAX_NAME:
            return (
                f"its name is longer than {MAX_NAME} bytes" if part.isprintable() else "its name is not text"
            )
    return ""


def _bad_kind(mode: int) -> str:
    """Why it is no file, or ""; archives made elsewhere than on Unix say nothing of it."""
    return "" if stat.S_IFMT(mode) in (0, stat.S_IFREG) else "it is a link or a device"


def _fits(parts: tuple[str, ...], data: bytes, refuse: Refuse) -> bool:
    if len(data) > MAX_BYTES:
        refuse("/".join(parts), f"it has more than {MAX_BYTES} bytes")
    return len(data) <= MAX_BYTES
