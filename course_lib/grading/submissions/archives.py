"""Files in submissions and downloads, read within limits and as untrusted data."""

import os
import re
import stat
import unicodedata
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
from course_lib.grading.submissions.notebook import (
    LOOKS_LIKE,
    MAX_BYTES,
    MAX_WITH_OUTPUTS,
    format_of,
    is_notebook_name,
    without_outputs,
)
from course_lib.third_party import read_bytes

MAX_MEMBERS = 1000  # limit on the files in an archive
MAX_ENTRIES = 20 * MAX_MEMBERS  # limit on entries, which inner archives have as well
ENTRY = b"PK\x01\x02"  # signature of each entry in an archive's directory
# zipfile decompresses other methods without a size limit.
METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
ENCRYPTED, UTF_8 = 0x1, 0x800  # flags of a file, and of its name
MAX_DEPTH = 3  # limit on the nesting of archives
MAX_NAME = 255  # [B] limit on a path component, that of file systems
MAX_PATH = 1000  # [B] limit on a path
MAX_UNPACKED_FILES = 1000  # limit on the files in all archives of a student
MAX_UNPACKED_BYTES = 50_000_000  # [B] limit on the total size of these files
RECEIPT = "receipt.json"  # file name in the zip of `course submit`
JUNK = ("__MACOSX", "Thumbs.db")
MOODLE_MARK = "_assignsubmission_"  # occurs in the names that Moodle writes
MAC_NAMES = (".DS_Store", ".localized")  # files that macOS adds to every folder
CONTROLS = ("Cc", "Cs", "Zl", "Zp")  # categories of characters that no name contains
# These characters reverse the text after them, so that a name is displayed as another one.
BIDI_CONTROLS = "\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
HIDDEN = "a name in its path begins with a dot, and the student submitted no visible file. Rename it"

Reject = Callable[[str, str], None]  # called with a file's name and the reason
Owner = Callable[[tuple[str, ...]], str]  # maps a path to the owner, whose archives share a limit
Wanted = Callable[[tuple[str, ...]], bool]
WORKING_SUFFIXES = (".rviz", ".yaml", ".yml", ".xml", ".urdf", ".py")
WORKING_FOLDER = "files/"  # folder in the zip of `course submit`
MAX_WORKING_BYTES = 1_000_000  # [B] limit on a working file
MAX_WORKING_FILES = 20
MAX_NAMES = 1000  # limit on the file names searched in a notebook
_QUOTED = re.compile(r"""["']([^"'\n]{1,200})["']""")


@contextmanager
def open_zip(data: bytes) -> Iterator[zipfile.ZipFile]:
    """Open an archive. Its directory is parsed only if it is short.

    Raises:
        CourseError: It is not a zip file, is damaged, or has more than MAX_MEMBERS files.
    """
    _check_count(data.count(ENTRY), MAX_ENTRIES)
    with _archive(BytesIO(data)) as archive:
        _check_count(len(archive.infolist()), MAX_MEMBERS)
        yield archive


def _archive(file: Path | BytesIO) -> zipfile.ZipFile:
    problem = ""
    try:
        with file.open("rb") if isinstance(file, Path) else BytesIO(file.getbuffer()[:100]) as stream:
            start = stream.read(100)
        problem = "it looks like a notebook" if start.lstrip().startswith(b"{") else format_of(start)
        return zipfile.ZipFile(file)
    except Exception as error:
        # A damaged archive can raise many kinds of exceptions.
        if isinstance(error, FileNotFoundError):
            problem = "there is no such file"
        elif problem == LOOKS_LIKE[b"pk"]:
            problem = f"it is damaged or incomplete ({error})"
        raise CourseError(f"it is not a readable zip file: {problem or error}") from error


def read_member(archive: zipfile.ZipFile, member: zipfile.ZipInfo | str, max_bytes: int) -> bytes:
    """Decompress at most `max_bytes` + 1 bytes of one file, regardless of the size that the archive declares.

    Raises:
        CourseError: The file does not exist, is encrypted or damaged, or uses an unsupported
            compression.
    """
    try:
        info = archive.getinfo(member) if isinstance(member, str) else member
        if info.flag_bits & ENCRYPTED:
            raise ValueError("it is encrypted. Submit it without a password")
        if info.compress_type not in METHODS:
            raise ValueError(f"compression method {info.compress_type}, expected stored or deflated")
        with archive.open(info) as file:
            return file.read(max_bytes + 1)
    except Exception as error:
        # A damaged or encrypted archive can raise many kinds of exceptions.
        raise CourseError(f"can't be unpacked: {error}") from error


def _check_count(count: int, max_count: int) -> None:
    if count > max_count:
        raise CourseError(f"it has {count} files, expected at most {MAX_MEMBERS}")


@dataclass(frozen=True)
class ReceivedFile:
    """A file of a download or a folder of submissions.

    Args:
        components: The components of its path, including the names of archives.
        data: Its content.
        time: The time in the file system or the innermost archive, which its author can set.
    """

    components: tuple[str, ...]
    data: bytes
    time: datetime


@dataclass
class ReceivedFileReader:
    """A reader of one folder or zip file.

    Args:
        reject: Called for each file that is skipped.
        owner: Returns the owner of a path; the limits on decompressed data apply per owner.
        is_wanted: Whether a file outside of nested archives is read.
    """

    reject: Reject
    owner: Owner = lambda parts: parts[0]
    is_wanted: Wanted = lambda parts: True
    _files: Counter[str] = field(default_factory=Counter)
    _bytes: Counter[str] = field(default_factory=Counter)
    _exhausted_owners: set[str] = field(default_factory=set)
    _visible_owners: set[str] = field(default_factory=set)
    _hidden: dict[str, str] = field(default_factory=dict)  # the first hidden file by owner

    def read(self, top: Path) -> Iterator[ReceivedFile]:
        """Yield all files of a folder or zip file, including files in nested zip files.

        Hidden files are skipped. If all files of an owner are hidden, they are rejected with a
        message, so that every student is listed.

        Raises:
            CourseError: `top` is not a folder or a zip file.
        """
        if top.is_dir():
            for arrival in self._walk(top):
                yield from self._open(arrival, 0)
        else:
            with _platform_zip(top) as archive:
                for arrival in self._members(archive, ()):
                    yield from self._open(arrival, 1)
        for owner, name in self._hidden.items():
            if owner not in self._visible_owners:
                self.reject(name, HIDDEN)

    def _is_skipped(self, parts: tuple[str, ...], start: int = 0) -> bool:
        """Return whether a component from `start` on is junk; record the owner of the file."""
        junk = [name for name in parts[start:] if _is_junk(name)]
        if not junk:
            self._visible_owners.add(self.owner(parts))
        elif junk[0] not in (parts[0], *JUNK, *MAC_NAMES) and not junk[-1].startswith("._"):
            self._hidden.setdefault(self.owner(parts), "/".join(parts))
        return bool(junk)

    def _walk(self, top: Path) -> Iterator[ReceivedFile]:
        for folder, folders, names in os.walk(top):
            folder_path = Path(folder)
            links = [name for name in folders if (folder_path / name).is_symlink()]
            hidden = [name for name in folders if _is_junk(name)]
            folders[:] = sorted(name for name in folders if not _is_junk(name))
            for path in (folder_path / name for name in sorted([*names, *links, *hidden])):
                parts = path.relative_to(top).parts
                if not self.is_wanted(parts) or self._is_skipped(parts):
                    continue
                try:
                    problem = path_problem(parts, by_platform=True)
                    if problem := problem or _type_problem(path.lstat().st_mode):
                        self.reject("/".join(parts), problem)
                        continue
                    with open(os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK), "rb") as file:
                        data = file.read(_max_bytes(parts) + 1)
                        time = datetime.fromtimestamp(os.fstat(file.fileno()).st_mtime, UTC)
                except OSError as error:
                    self.reject("/".join(parts), f"can't be read: {error.strerror}")
                else:
                    if (content := self._limit_content(parts, data)) is not None:
                        yield ReceivedFile(parts, content, time)

    def _open(self, arrival: ReceivedFile, depth: int) -> Iterator[ReceivedFile]:
        """Yield the file, or the contents of an archive unless `course submit` wrote it."""
        if not arrival.components[-1].lower().endswith(".zip"):
            yield arrival
            return
        try:
            with open_zip(arrival.data) as archive:
                if RECEIPT in archive.namelist():
                    yield arrival
                elif depth >= MAX_DEPTH:
                    raise CourseError("archives are nested too deeply")
                else:
                    names = [
                        name
                        for name in map(_member_name, archive.infolist())
                        if not name.endswith(("/", "\\"))
                    ]
                    if all(any(map(_is_junk, name.replace("\\", "/").split("/"))) for name in names):
                        which = f" except {names[0]}, which a program has added" if names else ""
                        raise CourseError(f"it contains no files{which}")
                    for inner in self._members(archive, arrival.components):
                        yield from self._open(inner, depth + 1)
        except CourseError as error:
            self.reject("/".join(arrival.components), str(error))

    def _members(self, archive: zipfile.ZipFile, above: tuple[str, ...]) -> Iterator[ReceivedFile]:
        names = Counter[str]()
        for info in archive.infolist():
            name = _member_name(info)
            if above and "/" not in name:
                # Written by old Windows programs.
                name = name.replace("\\", "/")
            inner = tuple(name.split("/"))
            parts = (*above, *inner)
            if name.endswith("/") or (not above and not self.is_wanted(parts)):
                continue
            if self._is_skipped(parts, len(above)):
                continue
            names[name] += 1
            if names[name] > 2:
                continue
            duplicate = "the archive contains this name twice" if names[name] == 2 else ""
            problem = duplicate or path_problem(inner, by_platform=not above)
            if problem := problem or _type_problem(info.external_attr >> 16):
                self.reject("/".join(parts), problem)
                continue
            owner = self.owner(parts)
            if owner in self._exhausted_owners:
                continue
            try:
                data = self._unpack(archive, info, owner, counted=bool(above))
            except CourseError as error:
                self.reject("/".join(parts), str(error))
                continue
            try:
                time = datetime(*info.date_time)
            except ValueError:
                # The time stamp is invalid, such as month 0 or hour 31.
                time = datetime(1980, 1, 1)
            if (content := self._limit_content(parts, data)) is not None:
                yield ReceivedFile(parts, content, time)

    def _unpack(
        self,
        archive: zipfile.ZipFile,
        info: zipfile.ZipInfo,
        owner: str,
        *,
        counted: bool,
    ) -> bytes:
        """Decompress a file within its owner's remaining limit.

        The platform's own archive is not counted.

        Raises:
            CourseError: It can't be decompressed, or the owner's limit is exceeded; then the
                owner's other files are skipped.
        """
        max_bytes = _max_bytes(tuple(info.filename.split("/")))
        remaining_bytes = MAX_UNPACKED_BYTES - self._bytes[owner] if counted else max_bytes + 1
        data = read_member(archive, info, min(max_bytes, remaining_bytes))
        self._files[owner] += counted
        self._bytes[owner] += len(data) if counted else 0
        if len(data) > remaining_bytes or self._files[owner] > MAX_UNPACKED_FILES:
            self._exhausted_owners.add(owner)
            raise CourseError(
                f"all archives of {owner} together unpack to more than {MAX_UNPACKED_BYTES:,} "
                f"bytes or {MAX_UNPACKED_FILES} files: this file and all later ones of {owner} are "
                "skipped"
            )
        return data

    def _limit_content(self, parts: tuple[str, ...], data: bytes) -> bytes | None:
        """Return a file's content, of a large notebook without outputs; None if it is too large."""
        if len(data) <= MAX_BYTES:
            return data
        content = without_outputs(data) if len(data) <= _max_bytes(parts) else data
        if len(content) <= MAX_BYTES:
            return content
        advice = ""
        if is_notebook_name(parts[-1]):
            advice = " without its outputs. Remove everything that is not part of the exercise"
            if len(data) > MAX_WITH_OUTPUTS:
                advice = f", and more than {MAX_WITH_OUTPUTS} with its outputs. Clear them and save it"
        self.reject("/".join(parts), f"it has more than {MAX_BYTES:,} bytes{advice}")
        return None


def list_paths(top: Path) -> list[tuple[str, ...]]:
    """Return the paths of the files in a folder or zip file, without files that operating systems add.

    Raises:
        CourseError: `top` is not a folder or a zip file.
    """
    if top.is_dir():
        walked = ((Path(folder), names) for folder, _, names in os.walk(top))
        paths = [(folder / name).relative_to(top).parts for folder, names in walked for name in names]
    else:
        with _platform_zip(top) as archive:
            names = [name for name in map(_member_name, archive.infolist()) if not name.endswith("/")]
        paths = [tuple(name.split("/")) for name in names]
    visible = (path for path in paths if not any(map(_is_junk, path)))
    return sorted(path for path in visible if not path_problem(path, by_platform=True))


def empty_folders(top: Path) -> list[str]:
    """Return the names of the folders in `top` without files, except files that programs add."""
    empty = []
    for folder in sorted(path for path in top.iterdir() if path.is_dir() and not path.is_symlink()):
        files = (path for path in folder.rglob("*") if path.is_symlink() or not path.is_dir())
        if all(any(map(_is_junk, path.relative_to(top).parts)) for path in files):
            empty.append(folder.name)
    return [name for name in empty if not _is_junk(name)]


def _max_bytes(parts: tuple[str, ...]) -> int:
    """Return the maximum number of bytes to read; for a notebook it includes outputs."""
    return MAX_WITH_OUTPUTS if is_notebook_name(parts[-1]) else MAX_BYTES


def _platform_zip(top: Path) -> zipfile.ZipFile:
    try:
        return _archive(top)
    except CourseError as error:
        raise CourseError(
            f"{top} is not a folder, and {error}. Pass the platform's download, a zip file or a folder."
        ) from error


def _member_name(info: zipfile.ZipInfo) -> str:
    """Return the name of a file in an archive. macOS writes UTF-8 without declaring it."""
    name = info.orig_filename
    if info.flag_bits & UTF_8:
        return name
    try:
        return name.encode("cp437").decode()
    except UnicodeError:
        return name


def _is_junk(name: str) -> bool:
    # Moodle's folder of a student whose name begins with a dot is not hidden.
    is_hidden = name.startswith(".") and name != ".." and MOODLE_MARK not in name
    return name in JUNK or is_hidden


def path_problem(parts: tuple[str, ...], *, by_platform: bool = False) -> str:
    """Return why a path is not acceptable, or "".

    Args:
        parts: The components.
        by_platform: The platform wrote the path, which has the student's name: whoever has
            directional overrides in it can't rename the file. The name that the student gave to the
            file is tested separately.
    """
    if sum(len(part.encode("utf-8", "replace")) for part in parts) > MAX_PATH:
        return f"its path is longer than {MAX_PATH} bytes"
    for part in parts:
        if part in ("", ".", "..") or "\\" in part or (len(part) > 1 and part[1] == ":"):
            return "its path leads out of the folder"
        # Names of persons contain other invisible characters: joiners in Persian and Sinhala, wide
        # and no-break spaces, direction marks.
        for character in part:
            is_override = character in BIDI_CONTROLS and not by_platform
            if is_override or unicodedata.category(character) in CONTROLS:
                code = f"U+{ord(character):04X}"
                return f"its name contains the invisible character {code}. Rename the file"
        if len(part.encode("utf-8", "replace")) > MAX_NAME:
            return f"its name is longer than {MAX_NAME} bytes"
    return ""


def _type_problem(mode: int) -> str:
    """Return an error message for an entry that is not a regular file, else "".

    Not all archives record the file type.
    """
    return "" if stat.S_IFMT(mode) in (0, stat.S_IFREG) else "it is a link or a device"


def working_files(path: Path, cells: Sequence[str]) -> dict[str, str]:
    """Return the contents of the text files submitted with a notebook, by path relative to its folder.

    Raises:
        CourseError: They can't be read.
    """
    files: dict[str, str] = {}
    try:
        for name, data in _read_working_files(path, cells):
            # The replacement of invalid bytes may triple the size.
            text = data.decode("utf-8", "replace")
            if len(files) < MAX_WORKING_FILES and len(text.encode()) <= MAX_WORKING_BYTES:
                files[name] = text
    except (OSError, CourseError) as error:
        raise CourseError(f"{path.name}: the files with the notebook can't be read: {error}") from error
    return files


def _read_working_files(path: Path, cells: Sequence[str]) -> Iterator[tuple[str, bytes]]:
    """Yield the files that `course submit` packed with a notebook, or that a plain notebook reads.

    The latter are in its folder, and their names occur in string literals of the cells.
    """
    if path.suffix.lower() == ".zip":
        with open_zip(read_bytes(path)) as archive:
            for info in archive.infolist()[: 2 * MAX_WORKING_FILES]:
                name = _member_name(info).removeprefix(WORKING_FOLDER)
                if name != _member_name(info) and _is_fine(name):
                    yield name, read_member(archive, info, MAX_WORKING_BYTES)
        return
    home = path.parent.resolve()
    quoted = (name for cell in cells for name in _QUOTED.findall(cell) if _is_fine(name))
    for name in dict.fromkeys(islice(quoted, MAX_NAMES)):
        place = home / name
        # The path does not contain a symbolic link.
        if place.is_file() and place.resolve() == place:
            with place.open("rb") as file:
                yield name, file.read(MAX_WORKING_BYTES + 1)


def _is_fine(name: str) -> bool:
    if not name.lower().endswith(WORKING_SUFFIXES):
        return False
    path = PurePosixPath(name)
    return not path.is_absolute() and not path_problem(path.parts) and path.suffix != ""
