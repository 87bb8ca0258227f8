"""Namespaces: a process tree, a network without a way out, and a view of the files, all of its own."""

import ctypes
import os
from pathlib import Path

from course_lib.grading.jail.system_calls import DUMPABLE, function, prctl, syscall

MOUNTS, HOST_NAME, IPC, USER, PROCESSES, NETWORK = (
    0x20000, 0x4000000, 0x8000000, 0x10000000, 0x20000000, 0x40000000
)  # fmt: skip
PRIVATE, RECURSIVE = 1 << 18, 1 << 14
READ_ONLY, NO_SUID, NO_DEVICES = 1, 2, 4
MOUNT_SETATTR, AT_ROOT, AT_RECURSIVE = 442, -100, 0x8000
INODES = 4096  # files in the scratch folder


class _MountAttributes(ctypes.Structure):
    _fields_ = tuple((name, ctypes.c_uint64) for name in ("set", "clear", "propagation", "user"))


def enter() -> None:
    """Leave the namespaces of the parent; the next fork is the first of its own process tree.

    Raises:
        OSError: This system does not allow it.
    """
    user, group = os.geteuid(), os.getegid()
    function("unshare", MOUNTS | HOST_NAME | IPC | USER | PROCESSES | NETWORK)
    prctl(DUMPABLE, 1)  # else the next files are not ours to write
    Path("/proc/self/setgroups").write_text("deny")
    Path("/proc/self/uid_map").write_text(f"{user} {user} 1")
    Path("/proc/self/gid_map").write_text(f"{group} {group} 1")


def own_files(scratch: str, megabytes: float) -> None:
    """Make all files read-only, and the scratch folder an empty one in memory, of bounded size.

    Raises:
        OSError: This system does not allow it.
    """
    _mount(None, "/", RECURSIVE | PRIVATE)
    attributes = _MountAttributes(READ_ONLY | NO_SUID, 0, 0, 0)
    size = ctypes.c_size_t(ctypes.sizeof(attributes))
    syscall(MOUNT_SETATTR, AT_ROOT, b"/", AT_RECURSIVE, ctypes.byref(attributes), size)
    _mount("tmpfs", "/proc", READ_ONLY | NO_SUID | NO_DEVICES, "size=4k")
    _mount("tmpfs", scratch, NO_SUID | NO_DEVICES, f"size={megabytes:.0f}m,nr_inodes={INODES},mode=700")


def _mount(kind: str | None, where: str, flags: int, options: str = "") -> None:
    name = kind.encode() if kind else None
    function("mount", name, where.encode(), name, ctypes.c_ulong(flags), options.encode())
