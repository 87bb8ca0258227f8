"""Namespaces: a process tree, a network without a way out, and a view of the files, all of its own."""

import ctypes
import os
from collections.abc import Iterable
from pathlib import Path

from course_lib.grading.jail.system_calls import DUMPABLE, function, prctl, syscall

MOUNTS, HOST_NAME, IPC, USER, PROCESSES, NETWORK = (
    0x20000, 0x4000000, 0x8000000, 0x10000000, 0x20000000, 0x40000000
)  # fmt: skip
BIND, PRIVATE, RECURSIVE = 1 << 12, 1 << 18, 1 << 14
READ_ONLY, NO_SUID, NO_DEVICES = 1, 2, 4
DETACH = 2  # of umount2
MOUNT_SETATTR, AT_ROOT, AT_RECURSIVE = 442, -100, 0x8000
INODES = 4096  # files in the scratch folder
COVERED, OLD = "/tmp", "/.old"  # where the new root is built, and where the old one is meanwhile
MEGABYTES = 64  # [MB] of what imports write before any submission runs


class _MountAttributes(ctypes.Structure):
    _fields_ = tuple((name, ctypes.c_uint64) for name in ("set", "clear", "propagation", "user"))


def enter() -> None:
    """Leave the namespaces of the parent; the next fork is the first of its own process tree.

    Raises:
        OSError: This system does not allow it.
    """
    kinds = MOUNTS | HOST_NAME | IPC | PROCESSES | NETWORK
    try:
        _with_own_users(kinds)  # counts processes from zero, too
    except OSError:
        function("unshare", kinds)  # what only root may do


def own_root(
    read: Iterable[str], listed: Iterable[str], links: Iterable[tuple[str, str]], scratch: str
) -> None:
    """Change to a root that holds only some files, read-only, and an empty scratch folder.

    Args:
        read: Files and folders, each once, without symbolic links on the way to them.
        listed: Folders with more than that, of which the names of what is shown can be read.
        links: Symbolic links to make, and their targets.
        scratch: A folder to make, in memory.

    Raises:
        OSError: This system does not allow it.
    """
    try:
        function("unshare", MOUNTS)
    except OSError:
        _with_own_users(MOUNTS)
    _mount(None, "/", RECURSIVE | PRIVATE)
    _change_mounts("/", _MountAttributes(set=READ_ONLY | NO_SUID))  # nothing below can change a file
    _mount("tmpfs", COVERED, NO_SUID | NO_DEVICES, "mode=111")
    os.umask(0o666)  # folders on the way can be gone through and no more
    os.mkdir(COVERED + OLD)
    function("pivot_root", COVERED.encode(), (COVERED + OLD).encode())
    os.chdir("/")
    _fill_root(read, listed, links)
    os.makedirs(os.path.dirname(scratch))
    os.umask(0o022)
    function("umount2", OLD.encode(), DETACH)
    os.rmdir(OLD)
    _change_mounts("/", _MountAttributes(set=READ_ONLY | NO_SUID))
    _change_mounts("/proc", _MountAttributes(clear=READ_ONLY))  # where users of namespaces are mapped
    _mount("tmpfs", os.path.dirname(scratch), NO_SUID | NO_DEVICES, f"size={MEGABYTES}m,mode=755")
    os.mkdir(scratch)


def _fill_root(read: Iterable[str], listed: Iterable[str], links: Iterable[tuple[str, str]]) -> None:
    for link, target in links:
        os.makedirs(os.path.dirname(link), exist_ok=True)
        os.symlink(target, link)
    for folder in listed:
        os.makedirs(folder, exist_ok=True)
        os.chmod(folder, 0o555)
    for path in (*read, "/proc"):
        _show(path)


def own_files(scratch: str, megabytes: float) -> None:
    """Mount all files read-only, and a bounded folder in memory as the scratch folder.

    Raises:
        OSError: This system does not allow it.
    """
    _mount(None, "/", RECURSIVE | PRIVATE)
    _change_mounts("/", _MountAttributes(set=READ_ONLY | NO_SUID))
    _mount("tmpfs", "/proc", READ_ONLY | NO_SUID | NO_DEVICES, "size=4k")
    _mount("tmpfs", scratch, NO_SUID | NO_DEVICES, f"size={megabytes:.0f}m,nr_inodes={INODES},mode=700")


def _with_own_users(kinds: int) -> None:
    user, group = os.geteuid(), os.getegid()
    function("unshare", kinds | USER)
    prctl(DUMPABLE, 1)  # else the next files are not ours to write
    Path("/proc/self/setgroups").write_text("deny")
    Path("/proc/self/uid_map").write_text(f"{user} {user} 1")
    Path("/proc/self/gid_map").write_text(f"{group} {group} 1")


def _show(path: str) -> None:
    """Mount a file or folder of the old root in the new one."""
    if os.path.isdir(OLD + path):
        os.makedirs(path, exist_ok=True)
    else:
        os.makedirs(os.path.dirname(path), exist_ok=True)
        Path(path).touch()
    flags = ctypes.c_ulong(BIND | RECURSIVE)
    function("mount", os.fsencode(OLD + path), os.fsencode(path), None, flags, None)


def _change_mounts(where: str, attributes: _MountAttributes) -> None:
    """Change what is mounted at a folder and below it."""
    size = ctypes.c_size_t(ctypes.sizeof(attributes))
    syscall(MOUNT_SETATTR, AT_ROOT, where.encode(), AT_RECURSIVE, ctypes.byref(attributes), size)


def _mount(kind: str | None, where: str, flags: int, options: str = "") -> None:
    name = kind.encode() if kind else None
    function("mount", name, os.fsencode(where), name, ctypes.c_ulong(flags), options.encode())
