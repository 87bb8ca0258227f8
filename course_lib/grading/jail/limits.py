"""Limits on what one submission uses: those of the kernel, and one on the scratch folder's size."""

import os
import resource
import signal
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from course_lib.course.course_file import Limits
from course_lib.grading.run.outcome import Usage

MEGABYTE = 2**20
OPEN_FILES = 128
SPARE_SECONDS = 10  # [s] of processor time beyond the wall clock's limit, which comes first
EVERY = 0.05  # [s]
MANY = 4096  # files, of which no more are counted


def apply(limits: Limits, *, counts_from_zero: bool) -> None:
    """Bound this process and what it starts.

    Args:
        limits: What course.toml says.
        counts_from_zero: Whether the kernel counts processes from 0 in here, not all of the user's.
    """
    others = 0 if counts_from_zero else _threads_of(os.getuid())
    wanted = {
        "RLIMIT_CORE": 0,
        "RLIMIT_CPU": limits.total_seconds + SPARE_SECONDS,
        "RLIMIT_AS": limits.memory_megabytes * MEGABYTE,
        "RLIMIT_FSIZE": limits.scratch_megabytes * MEGABYTE,
        "RLIMIT_NOFILE": OPEN_FILES,
        "RLIMIT_NPROC": others + limits.processes,
    }
    for name, value in wanted.items():
        kind = getattr(resource, name, None)
        if kind is not None:
            most = resource.getrlimit(kind)[1]
            value = round(value) if most == resource.RLIM_INFINITY else min(round(value), most)
            resource.setrlimit(kind, (value, value))


def _threads_of(user: int) -> int:
    """Return the number of a user's threads, which the kernel counts as processes."""
    count = 0
    for tasks in Path("/proc").glob("[0-9]*/task"):
        with suppress(OSError):  # the process has just ended
            count += len(os.listdir(tasks)) if tasks.stat().st_uid == user else 0
    return count


def stop_writing(folder: str, megabytes: float) -> Usage:
    """Refuse any further writing by descendants if the folder holds far more than a limit.

    Returns:
        What it holds.
    """
    held = Usage(files_megabytes=round(_size(folder) / 2**20, 1))
    if held.fills(megabytes):
        for pid in descendants(os.getpid()):
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


def descendants(pid: int) -> Iterator[int]:
    """Yield the numbers of all processes below one; none where the kernel does not list them."""
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        with suppress(OSError):  # it has just ended
            for child in map(int, task.read_text().split()):
                yield child
                yield from descendants(child)
