"""Layers of the jail around its filters: resource limits and namespaces.

The limits are the kernel's, and a limit on the size of the scratch folder. Namespaces give a
separate process tree, no network, and a private view of the file system.
"""

import ctypes
import os
import resource
import signal
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

from course_lib.course.course_file import Limits
from course_lib.grading.jail.filters import DUMPABLE, call_function, prctl, syscall
from course_lib.grading.run.outcome import Excess, Usage

MEGABYTE = 2**20
OPEN_FILES = 128
SPARE_SECONDS = 10  # [s] CPU time beyond the wall-clock limit, which is reached first
EVERY = 0.05  # [s] interval of the checks of all files and of all processes together
PAGE_FAULTS = 7  # index of the minor page faults in /proc/PID/stat, counted after the name


def apply_limits(limits: Limits, *, counts_from_zero: bool) -> None:
    """Limit the resources of this process and its children.

    Args:
        limits: The limits of course.toml.
        counts_from_zero: Whether the kernel counts only processes in the jail, not all of the
            user's.
    """
    running_threads = 0 if counts_from_zero else _threads_of(os.getuid())
    soft_limits = {
        "RLIMIT_CORE": 0,
        "RLIMIT_CPU": limits.total_seconds + SPARE_SECONDS,
        "RLIMIT_AS": limits.memory_megabytes * MEGABYTE,
        "RLIMIT_FSIZE": limits.scratch_megabytes * MEGABYTE,
        "RLIMIT_NOFILE": OPEN_FILES,
        "RLIMIT_NPROC": running_threads + limits.processes,
    }
    for name, value in soft_limits.items():
        kind = getattr(resource, name, None)
        if kind is not None:
            hard_limit = resource.getrlimit(kind)[1]
            value = round(value) if hard_limit == resource.RLIM_INFINITY else min(round(value), hard_limit)
            resource.setrlimit(kind, (value, value))


def _threads_of(user: int) -> int:
    """Return the number of a user's threads, which the kernel counts as processes."""
    count = 0
    for tasks in Path("/proc").glob("[0-9]*/task"):
        # The process may have just ended.
        with suppress(OSError):
            count += len(os.listdir(tasks)) if tasks.stat().st_uid == user else 0
    return count


def stop_writing(folder: str, megabytes: float) -> tuple[Usage, Excess | None]:
    """Forbid descendants to write more if the folder far exceeds its limit.

    Returns:
        The size of the folder, and why the descendants must be killed: files that are empty or
        small can't be forbidden otherwise.
    """
    size, count = _folder_size(folder)
    usage = Usage(files_megabytes=round(size / 2**20, 1))
    if usage.exceeds_by_far(megabytes):
        for pid in descendants(os.getpid()):
            with suppress(ProcessLookupError):
                try:
                    # The next write fails with "file too large".
                    resource.prlimit(pid, resource.RLIMIT_FSIZE, (0, 0))
                except PermissionError:
                    # Not permitted for a process with another real user id.
                    os.kill(pid, signal.SIGKILL)
    return usage, Excess("size", f"it wrote more than {INODES} files") if count > INODES else None


def check_memory(pid: int, inherited_bytes: int, megabytes: float) -> Excess | None:
    """Return an excess if the memory of all descendants of a process together exceeds a limit.

    The memory is the sum of the resident sets (RSS). The proportional sets (PSS) would count shared pages
    once, but only root may read them. A process that was just forked shares nearly all pages with
    its parent, so the pages of the template are subtracted from each, up to the pages that the
    process has written itself: it had a page fault for each of them.

    Args:
        pid: The process id of the template.
        inherited_bytes: The memory of the template [B].
        megabytes: The limit.
    """
    total, processes = 0, 0
    for process in descendants(pid):
        # The process may have just ended.
        with suppress(OSError, ValueError, IndexError):
            resident = resident_bytes(process)
            fields = Path(f"/proc/{process}/stat").read_bytes().rpartition(b")")[2].split()
            written = int(fields[PAGE_FAULTS]) * resource.getpagesize()
            total += max(resident - inherited_bytes, min(resident, written))
            # Ended processes have no memory.
            processes += resident > 0
    if total <= megabytes * MEGABYTE:
        return None
    return Excess(
        "memory",
        f"its {processes} processes together used {total / MEGABYTE:,.0f} MB of memory, more than "
        f"{megabytes:,.0f} MB",
    )


def resident_bytes(pid: int) -> int:
    """Return the resident anonymous and shared memory of a process [B].

    Raises:
        OSError: The process has ended, or the system is not Linux.
    """
    lines = Path(f"/proc/{pid}/status").read_bytes().splitlines()
    return sum(int(line.split()[1]) * 1024 for line in lines if line.startswith((b"RssAnon", b"RssShmem")))


def _folder_size(folder: str) -> tuple[int, int]:
    """Return the size of a folder [B] and the number of its files, without folders that can't be read.

    Counting stops after INODES files.
    """
    total, visited, waiting = 0, 0, [folder]
    while waiting and visited <= INODES:
        with suppress(OSError):
            for entry in os.scandir(waiting.pop()):
                visited += 1
                total += entry.stat(follow_symlinks=False).st_blocks * 512
                if entry.is_dir(follow_symlinks=False):
                    waiting.append(entry.path)
    return total, visited


def descendants(pid: int) -> Iterator[int]:
    """Yield the ids of all descendants of a process, or nothing on systems that do not list them."""
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        # The process may have just ended.
        with suppress(OSError):
            for child in map(int, task.read_text().split()):
                yield child
                yield from descendants(child)


MOUNTS, HOST_NAME, IPC, USER, PROCESSES, NETWORK = (
    0x20000, 0x4000000, 0x8000000, 0x10000000, 0x20000000, 0x40000000
)  # fmt: skip
BIND, PRIVATE, RECURSIVE = 1 << 12, 1 << 18, 1 << 14
READ_ONLY, NO_SUID, NO_DEVICES = 1, 2, 4
DETACH = 2  # flag of umount2
MOUNT_SETATTR, AT_ROOT, AT_RECURSIVE = 442, -100, 0x8000
INODES = 4096  # maximum number of files in the scratch folder
COVERED, OLD = "/tmp", "/.old"  # where the new root is built, and the old root's temporary mount point
MEGABYTES = 64  # [MB] size limit of files that imports write before any submission runs


class _MountAttributes(ctypes.Structure):
    _fields_ = tuple((name, ctypes.c_uint64) for name in ("set", "clear", "propagation", "user"))


def enter_namespaces() -> None:
    """Enter new namespaces. The next fork is the first process of the new process tree.

    Raises:
        OSError: The system does not allow it.
    """
    kinds = MOUNTS | HOST_NAME | IPC | PROCESSES | NETWORK
    try:
        # A user namespace also has its own count of processes.
        _unshare_users(kinds)
    except OSError:
        # Without a user namespace, only root may do this.
        call_function("unshare", kinds)


def enter_root(
    read: Iterable[str], listed: Iterable[str], links: Iterable[tuple[str, str]], scratch: str
) -> None:
    """Change to a root with only some files, read-only, and an empty scratch folder.

    Args:
        read: Unique paths of files and folders, without symbolic links.
        listed: Folders with other entries as well, of which only the visible ones can be listed.
        links: Symbolic links to create, with their targets.
        scratch: A folder to create in memory.

    Raises:
        OSError: The system does not allow it.
    """
    try:
        call_function("unshare", MOUNTS)
    except OSError:
        _unshare_users(MOUNTS)
    _mount(None, "/", RECURSIVE | PRIVATE)
    _change_mounts("/", _MountAttributes(set=READ_ONLY | NO_SUID))  # no file can be changed from here on
    _mount("tmpfs", COVERED, NO_SUID | NO_DEVICES, "mode=111")
    # Intermediate folders can be traversed, but not listed.
    os.umask(0o666)
    os.mkdir(COVERED + OLD)
    call_function("pivot_root", COVERED.encode(), (COVERED + OLD).encode())
    os.chdir("/")
    for link, target in links:
        os.makedirs(os.path.dirname(link), exist_ok=True)
        os.symlink(target, link)
    for folder in listed:
        os.makedirs(folder, exist_ok=True)
        os.chmod(folder, 0o555)
    for path in (*read, "/proc"):
        if os.path.isdir(OLD + path):
            os.makedirs(path, exist_ok=True)
        else:
            os.makedirs(os.path.dirname(path), exist_ok=True)
            Path(path).touch()
        flags = ctypes.c_ulong(BIND | RECURSIVE)
        call_function("mount", os.fsencode(OLD + path), os.fsencode(path), None, flags, None)
    os.makedirs(os.path.dirname(scratch))
    os.umask(0o022)
    call_function("umount2", OLD.encode(), DETACH)
    os.rmdir(OLD)
    _change_mounts("/", _MountAttributes(set=READ_ONLY | NO_SUID))
    _change_mounts("/proc", _MountAttributes(clear=READ_ONLY))  # user mappings are written there
    _mount("tmpfs", os.path.dirname(scratch), NO_SUID | NO_DEVICES, f"size={MEGABYTES}m,mode=755")
    os.mkdir(scratch)


def mount_files(scratch: str, megabytes: float) -> None:
    """Mount all files read-only, and a limited scratch folder in memory.

    Raises:
        OSError: The system does not allow it.
    """
    _mount(None, "/", RECURSIVE | PRIVATE)
    _change_mounts("/", _MountAttributes(set=READ_ONLY | NO_SUID))
    _mount("tmpfs", "/proc", READ_ONLY | NO_SUID | NO_DEVICES, "size=4k")
    _mount("tmpfs", scratch, NO_SUID | NO_DEVICES, f"size={megabytes:.0f}m,nr_inodes={INODES},mode=700")


def _unshare_users(kinds: int) -> None:
    user, group = os.geteuid(), os.getegid()
    call_function("unshare", kinds | USER)
    # Otherwise root owns the next files, and this process cannot write them.
    prctl(DUMPABLE, 1)
    Path("/proc/self/setgroups").write_text("deny")
    Path("/proc/self/uid_map").write_text(f"{user} {user} 1")
    Path("/proc/self/gid_map").write_text(f"{group} {group} 1")


def _change_mounts(where: str, attributes: _MountAttributes) -> None:
    """Change the attributes of the mounts at a folder and below it."""
    size = ctypes.c_size_t(ctypes.sizeof(attributes))
    syscall(MOUNT_SETATTR, AT_ROOT, where.encode(), AT_RECURSIVE, ctypes.byref(attributes), size)


def _mount(kind: str | None, where: str, flags: int, options: str = "") -> None:
    name = kind.encode() if kind else None
    call_function("mount", name, os.fsencode(where), name, ctypes.c_ulong(flags), options.encode())
