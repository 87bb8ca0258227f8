"""What one submission may use of the machine, by the kernel's own limits."""

import os
import resource
from contextlib import suppress
from pathlib import Path

from course_lib.course.course_file import Limits

MEGABYTE = 2**20
OPEN_FILES = 128
SPARE_SECONDS = 10  # [s] of processor time beyond the wall clock's limit, which comes first


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
    """How many threads a user has, which is what the kernel counts as processes."""
    count = 0
    for tasks in Path("/proc").glob("[0-9]*/task"):
        with suppress(OSError):  # the process has just ended
            count += len(os.listdir(tasks)) if tasks.stat().st_uid == user else 0
    return count
