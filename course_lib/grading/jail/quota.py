"""A bound on what a submission writes where its folder is on a disk: its size is measured again and again."""

import os
import resource
import signal
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from course_lib.grading.run.outcome import Usage

EVERY = 0.05  # [s]
MANY = 4096  # files, of which no more are counted


def stop_writing(folder: str, megabytes: float) -> Usage:
    """Let no process below this one write to a file any more, if the folder holds far more than a limit.

    Returns:
        What it holds.
    """
    held = Usage(files_megabytes=round(_size(folder) / 2**20, 1))
    if held.fills(megabytes):
        for pid in _descendants(os.getpid()):
            with suppress(ProcessLookupError):
                _refuse_files(pid)
    return held


def _refuse_files(pid: int) -> None:
    try:
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (0, 0))  # the next write says: file too large
    except PermissionError:  # its user only counts as another
        os.kill(pid, signal.SIGKILL)


def _size(folder: str) -> int:
    """Return the bytes in a folder, without those that can't be looked at."""
    total, seen, waiting = 0, 0, [folder]
    while waiting and seen < MANY:
        with suppress(OSError):
            for entry in os.scandir(waiting.pop()):
                seen += 1
                total += entry.stat(follow_symlinks=False).st_blocks * 512
                if entry.is_dir(follow_symlinks=False):
                    waiting.append(entry.path)
    return total


def _descendants(pid: int) -> Iterator[int]:
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        with suppress(OSError):  # it has just ended
            for child in map(int, task.read_text().split()):
                yield child
                yield from _descendants(child)
