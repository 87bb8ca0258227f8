"""Atomic writing of files and folders: each is complete or unchanged, however the program ends."""

import errno
import os
import re
import shutil
import signal
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from types import FrameType
from typing import NoReturn

from course_lib.errors import CourseError

# In robot time, `signal` shows a program only its own handlers. These functions were Python's when
# the kit was imported.
_set_handler, _get_handler = signal.signal, signal.getsignal
_DRAFT = re.compile(r"\.(.+)\.\w+\.draft")
_ERROR_CODE = re.compile(r"\[Errno (\d+)\]")
# A draft that was unchanged for this long belongs to a program that was killed.
_STALE_AFTER = 3600.0  # [s]
# Folders from which this process has removed stale drafts.
_swept: set[Path] = set()


def write_atomically(path: Path, data: bytes, mode: int = 0o666) -> None:
    """Write a file so that it is complete or unchanged. Its folder is created if it is missing.

    The content is written to a draft next to the file and synchronized to the disk, then the draft
    is renamed. A program that is killed leaves its draft, which a later one removes.

    Args:
        path: The file.
        data: The whole content.
        mode: Its permissions, reduced by the umask.

    Raises:
        OSError: The file cannot be written. The error contains its path, not the draft's.
    """
    draft = path.with_name(f".{path.name}.{os.getpid()}.draft")
    try:
        # A rename would replace a device such as /dev/null by a file, for all programs.
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise OSError(errno.EINVAL, "Not a regular file")
        path.parent.mkdir(parents=True, exist_ok=True)
        # A leftover draft may have different permissions.
        draft.unlink(missing_ok=True)
        with open(draft, "wb", opener=partial(os.open, mode=mode)) as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        draft.replace(path)
    except BaseException as error:
        # On a full disk, a partial draft would take up space.
        with suppress(OSError):
            draft.unlink()
        if isinstance(error, OSError):
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise
    _remove_stale_drafts(path)


def save_as(path: str | Path, data: bytes, subject: str) -> None:
    """Write a file that a user has named. A symbolic link stays, and its target is written.

    Args:
        path: The file.
        data: The whole content.
        subject: What it contains, like "the page", for the error message.

    Raises:
        CourseError: The file cannot be written.
    """
    try:
        write_atomically(Path(os.path.realpath(path)), data)
    except OSError as error:
        raise CourseError(
            f"Cannot write {subject} {path}: {error.strerror}. Choose another folder."
        ) from None


@contextmanager
def draft_folder(target: Path) -> Iterator[Path]:
    """Create a temporary folder next to a file or folder, in which its new content is prepared.

    Afterwards it is deleted, even if the program is ended by `kill` or with its terminal. After an
    error, so are the parents of the target that were created.

    Raises:
        OSError: The content cannot be written. The error contains the path of the target.
    """
    missing = [folder for folder in target.parents if not folder.exists()]
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with (
            _exit_on_signals(),
            tempfile.TemporaryDirectory(
                dir=target.parent, prefix=f".{target.name}.", suffix=".draft"
            ) as folder,
        ):
            yield Path(folder)
    except BaseException as error:
        with suppress(OSError):
            for parent in missing:
                parent.rmdir()
        # shutil.copytree collects the errors of all files as strings.
        if isinstance(error, shutil.Error) and (code := _ERROR_CODE.match(error.args[0][0][2])):
            raise OSError(int(code[1]), os.strerror(int(code[1])), str(target)) from error
        if isinstance(error, OSError):
            raise OSError(error.errno, error.strerror, str(target)) from error
        raise
    _remove_stale_drafts(target)


@contextmanager
def _exit_on_signals() -> Iterator[None]:
    """Raise SystemExit for signals that would end the program without deleting its temporary files.

    Signals with a handler are left to it, and so are all signals in a thread, where Python allows
    no handlers.
    """
    # Windows has no SIGHUP.
    numbers = [getattr(signal, name, signal.SIGTERM) for name in ("SIGTERM", "SIGHUP")]
    replaced = [number for number in {*numbers} if _get_handler(number) == signal.SIG_DFL]
    try:
        for number in replaced:
            _set_handler(number, _exit)
    except ValueError:
        replaced = []
    try:
        yield
    finally:
        for number in replaced:
            _set_handler(number, signal.SIG_DFL)


def _exit(number: int, frame: FrameType | None) -> NoReturn:
    # The exit code that a shell reports for a program ended by a signal.
    raise SystemExit(128 + number)


def _remove_stale_drafts(path: Path) -> None:
    """Remove the drafts of killed programs next to a file or folder that was written now.

    Drafts without their target stay, because a folder can be the only copy: a program may have been
    killed between the renaming of the former target and that of the new one.
    """
    if path.parent in _swept:
        return
    _swept.add(path.parent)
    with suppress(OSError):
        # The file system's clock may differ from the clock of this computer.
        limit = path.stat().st_ctime - _STALE_AFTER
        for draft in path.parent.iterdir():
            name = _DRAFT.fullmatch(draft.name)
            if name is None or draft.stat().st_mtime > limit or not draft.with_name(name[1]).exists():
                continue
            if draft.is_dir():
                shutil.rmtree(draft, ignore_errors=True)
            else:
                draft.unlink()
