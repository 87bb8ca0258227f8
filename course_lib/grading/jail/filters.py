"""The layers of the jail: kernel filters, resource limits and namespaces.

The filters are the accessible files (Landlock) and the rejected system calls (seccomp). The limits
are the kernel's, and limits on the size of the scratch folder and on the memory of all processes.
Namespaces give a separate process tree, no network, and a private view of the file system.
"""

import ctypes
import errno
import os
import platform
import resource
import signal
import stat
import struct
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Literal

from course_lib.course.course_file import Limits
from course_lib.errors import CourseError

NO_NEW_PRIVILEGES, DUMPABLE, CHILD_SUBREAPER, KEEP_CAPABILITIES = 38, 4, 36, 8  # prctl operations
CAPABILITIES_3 = 0x20080522  # version of the capability structures


@cache
def _libc() -> Any:
    library = ctypes.CDLL(None, use_errno=True)
    library.syscall.restype = ctypes.c_long
    return library


def call_function(name: str, *arguments: Any) -> int:
    """Call a function of the C library.

    Raises:
        OSError: It failed, or does not exist on this system.
    """
    called = getattr(_libc(), name, None)
    if called is None:
        raise OSError(f"{name}: not available on this system")
    result = int(called(*arguments))
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, f"{name}: {os.strerror(number)}")
    return result


def syscall(number: int, *arguments: Any) -> int:
    """Make a system call whose number is the same on all architectures, or raise an OSError."""
    return call_function("syscall", ctypes.c_long(number), *arguments)


def prctl(operation: int, *arguments: int) -> None:
    """Change an attribute of this process, or raise an OSError."""
    call_function("prctl", operation, *map(ctypes.c_ulong, (*arguments, 0, 0, 0, 0)[:4]))


def drop_capabilities() -> None:
    """Drop all capabilities of root or of a namespace's root, or raise an OSError."""
    header, none = (ctypes.c_uint32 * 2)(CAPABILITIES_3, 0), (ctypes.c_uint32 * 6)()
    call_function("capset", ctypes.byref(header), ctypes.byref(none))


def use_capabilities() -> None:
    """Make all permitted capabilities effective after a change of user, or raise an OSError."""
    header = (ctypes.c_uint32 * 2)(CAPABILITIES_3, 0)
    sets = (ctypes.c_uint32 * 6)()  # effective, permitted, inheritable; twice, for low and high numbers
    call_function("capget", ctypes.byref(header), ctypes.byref(sets))
    sets[0], sets[3] = sets[1], sets[4]
    call_function("capset", ctypes.byref(header), ctypes.byref(sets))


CREATE, ADD_RULE, RESTRICT = 444, 445, 446  # system call numbers
VERSION, PATH_BENEATH = 1, 1
EXECUTE, WRITE_FILE, READ_FILE, READ_DIR, TRUNCATE = 1 << 0, 1 << 1, 1 << 2, 1 << 3, 1 << 14
OF_FILES = EXECUTE | WRITE_FILE | READ_FILE | TRUNCATE
# number of file access rights by Landlock version; 16 from version 5 on
FILE_RIGHTS = {1: 13, 2: 14, 3: 15, 4: 15}
TCP_RIGHTS, SCOPES = 0b11, 0b11  # TCP bind and connect; abstract sockets and signals
TCP_FROM, SIGNALS_FROM = 4, 6  # first Landlock versions that support these
SET_SECCOMP, MODE_FILTER = 22, 2
# By machine: the column in the tables below, and the audit architecture.
MACHINES = {"x86_64": (0, 0xC000003E), "aarch64": (1, 0xC00000B7)}
NEWER = 450  # system calls from this number on are treated as unknown
X32 = 0x40000000  # x32 variants of the same calls
REJECTED = {
    "execve": (59, 221), "execveat": (322, 281),
    "kill": (62, 129), "tkill": (200, 130), "tgkill": (234, 131), "pidfd_send_signal": (424, 424),
    "rt_sigqueueinfo": (129, 138), "rt_tgsigqueueinfo": (297, 240),
    "ptrace": (101, 117), "process_vm_readv": (310, 270), "process_vm_writev": (311, 271),
    "kcmp": (312, 272), "pidfd_open": (434, 434), "pidfd_getfd": (438, 438),
    "process_madvise": (440, 440), "unshare": (272, 97), "setns": (308, 268),
    "mount": (165, 40), "umount2": (166, 39), "pivot_root": (155, 41), "chroot": (161, 51),
    "open_tree": (428, 428), "move_mount": (429, 429), "fsopen": (430, 430), "fsconfig": (431, 431),
    "fsmount": (432, 432), "fspick": (433, 433), "mount_setattr": (442, 442),
    "name_to_handle_at": (303, 264), "open_by_handle_at": (304, 265),
    "bpf": (321, 280), "perf_event_open": (298, 241), "userfaultfd": (323, 282),
    "io_uring_setup": (425, 425), "io_uring_enter": (426, 426), "io_uring_register": (427, 427),
    "keyctl": (250, 219), "add_key": (248, 217), "request_key": (249, 218),
    "init_module": (175, 105), "finit_module": (313, 273), "delete_module": (176, 106),
    "kexec_load": (246, 104), "kexec_file_load": (320, 294), "reboot": (169, 142),
    "swapon": (167, 224), "swapoff": (168, 225), "syslog": (103, 116), "acct": (163, 89),
    "quotactl": (179, 60), "quotactl_fd": (443, 443), "personality": (135, 92),
    "settimeofday": (164, 170), "clock_settime": (227, 112), "clock_adjtime": (305, 266),
    "adjtimex": (159, 171), "sethostname": (170, 161), "setdomainname": (171, 162),
    "mknod": (133, None), "mknodat": (259, 33), "memfd_secret": (447, 447), "fanotify_init": (300, 262),
    "shmget": (29, 194), "msgget": (68, 186), "semget": (64, 190), "mq_open": (240, 180),
    "shmat": (30, 196), "shmctl": (31, 195), "msgsnd": (69, 189), "msgrcv": (70, 188), "msgctl": (71, 187),
    "semop": (65, 193), "semctl": (66, 191), "semtimedop": (220, 192), "mq_unlink": (241, 181),
    "memfd_create": (319, 279), "truncate": (76, 45), "inotify_init": (253, None), "inotify_init1": (294, 26),
    "setpriority": (141, 140), "ioprio_set": (251, 30),
    "setuid": (105, 146), "setgid": (106, 144), "setreuid": (113, 145), "setregid": (114, 143),
    "setresuid": (117, 147), "setresgid": (119, 149), "setfsuid": (122, 151), "setfsgid": (123, 152),
    "setgroups": (116, 159), "capset": (126, 91),
    # A file in a message that was not received yet is in no list of open files.
    "sendmsg": (46, 211), "sendmmsg": (307, 269),
    "ioperm": (173, None), "iopl": (172, None), "modify_ldt": (154, None),
}  # fmt: skip
# Socket pairs are allowed: they have no network access, and asyncio needs one.
NETWORK = {"socket": (41, 198)}
# Calls that succeed without effect. Programs that copy files make them, and Landlock cannot forbid
# them.
PRETENDED = {
    "chmod": (90, None), "fchmod": (91, 52), "fchmodat": (268, 53),
    "chown": (92, None), "fchown": (93, 55), "lchown": (94, None), "fchownat": (260, 54),
    "utime": (132, None), "utimes": (235, None), "futimesat": (261, None), "utimensat": (280, 88),
    "setxattr": (188, 5), "lsetxattr": (189, 6), "fsetxattr": (190, 7),
    # Flushing waits for all disks of the machine, and the files are temporary anyway.
    "sync": (162, 81), "syncfs": (306, 267), "fsync": (74, 82), "fdatasync": (75, 83),
    "sync_file_range": (277, 84), "msync": (26, 227),
    "removexattr": (197, 14), "lremovexattr": (198, 15), "fremovexattr": (199, 16),
}  # fmt: skip
LOAD, IF_EQUAL, IF_AT_LEAST, IF_ANY_BIT, RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
CLONE, CLONE3 = (56, 220), (435, 435)
# Calls that are rejected if a test of an argument, counted from 0, is true.
BY_ARGUMENT = (
    (CLONE, 0, IF_ANY_BIT, (0x7E020080,)),  # new namespaces
    # A process id other than 0 (the caller): prlimit64, sched_setaffinity, _setscheduler,
    # _setparam, _setattr.
    *((call, 0, IF_AT_LEAST, (1,)) for call in ((302, 261), (203, 122), (144, 119), (142, 118), (314, 274))),
    # rt_sigaction: without SIGCHLD, the kernel would not count the times of ended processes.
    ((13, 134), 0, IF_EQUAL, (17,)),
    ((157, 167), 0, IF_EQUAL, (DUMPABLE,)),  # prctl: it would hide the open files from the template
    # fcntl: F_SETOWN, _SETSIG, _SETOWN_EX make the kernel send signals; F_SETLEASE blocks
    # other programs that write a file, and F_NOTIFY watches folders.
    ((72, 25), 1, IF_EQUAL, (8, 10, 15, 1024, 1026)),
    # ioctl: likewise, and TIOCSTI injects input into a terminal
    ((16, 29), 1, IF_EQUAL, (0x8901, 0x8902, 0x5412)),
    ((53, 199), 1, IF_ANY_BIT, (2,)),  # socketpair: datagrams can be sent to any socket
    # setsockopt: SO_SNDBUF, SO_RCVBUF and both with FORCE. Buffers are the kernel's memory, which
    # is in no process's sum, and each socket may have net.core.wmem_max, often 4 MB.
    ((54, 208), 2, IF_EQUAL, (7, 8, 32, 33)),
)
# Shared memory without a file outlives its mapping, so neither the limit of a process nor the sum
# of its pages counts it.
MAP, MAP_FLAGS, MAP_PRIVATE, MAP_ANONYMOUS = (9, 222), 3, 0x02, 0x20
ALLOW, KILL, ERROR = 0x7FFF0000, 0x80000000, 0x00050000
NUMBER, MACHINE, ARGUMENTS = 0, 4, 16  # offsets in the data of a filter; arguments have 8 bytes each


class _Ruleset(ctypes.Structure):
    _fields_ = (("files", ctypes.c_uint64), ("network", ctypes.c_uint64), ("scoped", ctypes.c_uint64))


class _PathBeneath(ctypes.Structure):
    _pack_ = 1
    _layout_ = "ms"
    _fields_ = (("allowed", ctypes.c_uint64), ("parent", ctypes.c_int32))


def restrict_files(read: Sequence[str], write: Sequence[str], listed: Sequence[str]) -> None:
    """Irrevocably restrict this process and its children to these files; missing paths are skipped.

    Args:
        read: Readable files, and folders with everything in them.
        write: Files and folders with all rights except execution.
        listed: Folders whose entries can be listed, but not read.

    Raises:
        OSError: The kernel has no Landlock, or the call fails.
    """
    version = syscall(CREATE, None, ctypes.c_size_t(0), VERSION)
    has_tcp, has_scopes = version >= TCP_FROM, version >= SIGNALS_FROM
    every = (1 << FILE_RIGHTS.get(version, 16)) - 1
    rules = _Ruleset(every, TCP_RIGHTS if has_tcp else 0, SCOPES if has_scopes else 0)
    # [B] size of the structure, by version
    size = ctypes.c_size_t(24 if has_scopes else 16 if has_tcp else 8)
    ruleset = syscall(CREATE, ctypes.byref(rules), size, 0)
    granted = ((read, EXECUTE | READ_FILE | READ_DIR), (write, every & ~EXECUTE), (listed, READ_DIR))
    for paths, rights in granted:
        for path in filter(os.path.exists, paths):
            parent = os.open(path, os.O_PATH | os.O_CLOEXEC)
            allowed = rights & every & (-1 if os.path.isdir(path) else OF_FILES)
            syscall(ADD_RULE, ruleset, PATH_BENEATH, ctypes.byref(_PathBeneath(allowed, parent)), 0)
            os.close(parent)
    prctl(NO_NEW_PRIVILEGES, 1)
    syscall(RESTRICT, ruleset, 0)
    os.close(ruleset)


class _FilterProgram(ctypes.Structure):
    _fields_ = (("length", ctypes.c_ushort), ("code", ctypes.c_void_p))


def filter_calls() -> None:
    """Irrevocably load the seccomp filter into this process and its children.

    Raises:
        OSError: The kernel rejects the filter.
    """
    code = filter_program(*MACHINES[platform.machine()])
    buffer = ctypes.create_string_buffer(code, len(code))
    loaded = _FilterProgram(len(code) // 8, ctypes.addressof(buffer))
    prctl(NO_NEW_PRIVILEGES, 1)
    call_function("prctl", SET_SECCOMP, MODE_FILTER, ctypes.byref(loaded), 0, 0)


def filter_program(column: int, machine: int) -> bytes:
    """Return the BPF code of the filter: pairs of a test and its action."""
    steps = [
        _step(LOAD, MACHINE), _step(IF_EQUAL, machine, 1, 0), _step(RETURN, KILL),
        _step(LOAD, NUMBER), *_if(IF_AT_LEAST, X32, KILL), *_if(IF_AT_LEAST, NEWER, ERROR | errno.ENOSYS),
        # Without clone3, threads are started by clone, whose flags a filter can read.
        *_if(IF_EQUAL, CLONE3[column], ERROR | errno.ENOSYS),
    ]  # fmt: skip
    for table, error in ((REJECTED, errno.EPERM), (NETWORK, errno.ENETDOWN), (PRETENDED, 0)):
        for row in table.values():
            number = row[column]
            # Some calls exist on one architecture only.
            if number is not None:
                steps += _if(IF_EQUAL, number, ERROR | error)
    for call, argument, test, values in BY_ARGUMENT:
        rejections = [step for value in values for step in _if(test, value, ERROR | errno.EPERM)]
        steps += [
            _step(IF_EQUAL, call[column], 0, len(rejections) + 2),
            _step(LOAD, ARGUMENTS + 8 * argument),
        ]
        steps += [*rejections, _step(RETURN, ALLOW)]
    steps += [
        _step(IF_EQUAL, MAP[column], 0, 6), _step(LOAD, ARGUMENTS + 8 * MAP_FLAGS),
        *_if(IF_ANY_BIT, MAP_PRIVATE, ALLOW), *_if(IF_ANY_BIT, MAP_ANONYMOUS, ERROR | errno.EPERM),
        _step(RETURN, ALLOW),
    ]  # fmt: skip
    return b"".join([*steps, _step(RETURN, ALLOW)])


def _step(code: int, value: int, if_true: int = 0, if_false: int = 0) -> bytes:
    return struct.pack("HBBI", code, if_true, if_false, value)


def _if(test: int, value: int, action: int) -> list[bytes]:
    return [_step(test, value, 0, 1), _step(RETURN, action)]


# getrusage reports bytes on macOS, and kilobytes on other systems.
_RSS_PER_MB = 1e6 if sys.platform == "darwin" else 1e3


@dataclass(frozen=True)
class Usage:
    """CPU time [s] of all processes, and the peak memory [MB] of the largest one.

    `files_megabytes` is the peak size of all files if they are on a disk; a scratch folder in
    memory is limited by the kernel. `scenarios` has the CPU time [s] of each scenario by task and
    name, as reported by the worker, which runs the student's code.
    """

    cpu_seconds: float = 0.0
    memory_megabytes: float = 0.0
    files_megabytes: float = 0.0
    scenarios: Mapping[str, float] = field(default_factory=dict)

    def __add__(self, other: "Usage") -> "Usage":
        memory = max(self.memory_megabytes, other.memory_megabytes)
        files = max(self.files_megabytes, other.files_megabytes)
        cpu = round(self.cpu_seconds + other.cpu_seconds, 3)
        return Usage(cpu, memory, files, {**self.scenarios, **other.scenarios})

    def exceeds_by_far(self, megabytes: float) -> bool:
        """Return whether all files together take far more than the limit of a single one."""
        return self.files_megabytes > 2 * megabytes


@dataclass(frozen=True)
class Excess:
    """Why the template killed a submission: a limit on the sum over all of its processes or files.

    Args:
        limit: The limit: "memory" or "size".
        message: What the submission did, for "it was stopped: …".
    """

    limit: str
    message: str


def wait_any_child() -> Usage:
    """Wait for any child to end, and return the usage of it and its own children.

    Raises:
        ChildProcessError: There is no child.
    """
    _, _, resources = os.wait3(0)
    return Usage(
        round(resources.ru_utime + resources.ru_stime, 3), round(resources.ru_maxrss / _RSS_PER_MB, 1)
    )


Need = Literal["full", "partial", "any"]  # the required isolation
LAYERS = ("bubblewrap", "namespaces", "Landlock", "seccomp", "limits", "process limit")


@dataclass(frozen=True)
class Isolation:
    """The layers of the jail that work on this machine."""

    layers: tuple[str, ...] = ()

    @property
    def is_full(self) -> bool:
        """True if no layer is missing except bubblewrap, which only duplicates others."""
        return set(LAYERS) - {"bubblewrap"} <= set(self.layers)

    @property
    def is_protective(self) -> bool:
        """True if the user's files and the network are inaccessible."""
        closes_files = self.hides_names or "Landlock" in self.layers
        cuts_off = self.hides_names or "seccomp" in self.layers
        return closes_files and cuts_off and "limits" in self.layers

    @property
    def hides_names(self) -> bool:
        """True if even the names of files are hidden."""
        return bool({"bubblewrap", "namespaces"} & set(self.layers))

    def __str__(self) -> str:
        """Return a description for results, reports and the terminal."""
        missing = [layer for layer in LAYERS[1:] if layer not in self.layers]
        have = ", ".join(self.layers)
        if self.is_full:
            return f"full sandbox ({have})"
        kind = "partial sandbox" if self.is_protective else "no sandbox"
        exposure = "" if self.hides_names or not self.is_protective else "; file names are not hidden"
        return f"{kind} ({f'has {have}; ' if have else ''}lacks {', '.join(missing)}{exposure})"

    def require(self, need: Need) -> None:
        """Raise an error if the isolation is weaker than required.

        Raises:
            CourseError: The message has the missing layers and a command to type.
        """
        if need == "full" and not self.is_full:
            raise CourseError(
                f"--require-sandbox: this machine has only: {self}. "
                "Grade on another Linux machine, or omit --require-sandbox."
            )
        if need == "partial" and not self.is_protective:
            raise CourseError(
                f"submissions would run with your rights, {self}: they could read and change your "
                "files. Grade on Linux 5.13 or newer, or WSL2; if this is a container on Linux, it "
                "forbids them: grade outside of it, or in one that allows Landlock and seccomp. If "
                "you trust all submissions, add --i-trust-these-submissions"
            )


MEGABYTE = 2**20
OPEN_FILES = 128
SPARE_SECONDS = 10  # [s] CPU time beyond the wall-clock limit, which is reached first
EVERY = 0.05  # [s] interval between the checks of total file size and memory
KILLED_FROM = 4  # size of all files, as a multiple of their limit, from which a submission is killed
PAGE_FAULTS = 7  # index of the minor page faults in /proc/PID/stat, counted after the name


def apply_limits(limits: Limits, inherited_bytes: int, *, counts_from_zero: bool) -> None:
    """Limit the resources of this process and its children.

    Args:
        limits: The limits of course.toml.
        inherited_bytes: The address space that this process has in common with its template [B].
        counts_from_zero: Whether the kernel counts only processes in the jail, not all of the
            user's.
    """
    # The kernel counts the threads of all the user's processes.
    running_threads, user = 0, os.getuid()
    for tasks in () if counts_from_zero else Path("/proc").glob("[0-9]*/task"):
        # The process may have just ended.
        with suppress(OSError):
            running_threads += len(os.listdir(tasks)) if tasks.stat().st_uid == user else 0
    soft_limits = {
        "RLIMIT_CORE": 0,
        "RLIMIT_CPU": limits.total_seconds + SPARE_SECONDS,
        "RLIMIT_AS": limits.memory_megabytes * MEGABYTE + inherited_bytes,
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


def address_space() -> int:
    """Return the size of this process's address space [B], or 0 if the system does not list it."""
    try:
        return int(Path("/proc/self/statm").read_bytes().split()[0]) * resource.getpagesize()
    except OSError:
        return 0


def stop_writing(folder: str, megabytes: float) -> tuple[Usage, Excess | None]:
    """Forbid descendants to write more if their files far exceed the limit.

    Returns:
        The size of the files, and why the descendants must be killed: files that are empty or
        small, and writing to mapped files, can't be forbidden otherwise.
    """
    size, count = _folder_size(folder)
    size += _deleted_files_size(os.getpid(), folder, megabytes * MEGABYTE)
    usage = Usage(files_megabytes=round(size / MEGABYTE, 1))
    if usage.exceeds_by_far(megabytes):
        for pid in descendants(os.getpid()):
            with suppress(ProcessLookupError):
                try:
                    # The next write fails with "file too large".
                    resource.prlimit(pid, resource.RLIMIT_FSIZE, (0, 0))
                except PermissionError:
                    # Not permitted for a process with another real user id.
                    os.kill(pid, signal.SIGKILL)
    if count > INODES:
        return usage, Excess("size", f"it wrote more than {INODES} files")
    if usage.files_megabytes > KILLED_FROM * megabytes:
        message = f"its files together had {usage.files_megabytes:,.0f} MB, more than {megabytes:,.0f} MB"
        return usage, Excess("size", message)
    return usage, None


def _deleted_files_size(pid: int, folder: str, max_size: float) -> int:
    """Return the size of deleted files that a process's descendants still use [B]; no folder lists them.

    The size of a file that is mapped but not open can't be read, so it counts as `max_size`.
    """
    sizes = dict[tuple[int, int], float]()
    is_listed = f" {folder.rstrip('/')}/".encode()
    for process in descendants(pid):
        # Each thread can have open files of its own. The process may have just ended.
        with suppress(OSError):
            for task in os.scandir(f"/proc/{process}/task"):
                for entry in os.scandir(f"{task.path}/fd"):
                    with suppress(OSError):
                        status = os.stat(entry.path)
                        if stat.S_ISREG(status.st_mode) and status.st_nlink == 0:
                            sizes[status.st_dev, status.st_ino] = status.st_blocks * 512
            for line in Path(f"/proc/{process}/maps").read_bytes().splitlines():
                if line.endswith(b" (deleted)") and is_listed in line:
                    _, _, _, device, inode, _ = line.split(maxsplit=5)
                    major, _, minor = device.partition(b":")
                    number = os.makedev(int(major, 16), int(minor, 16)), int(inode)
                    sizes.setdefault(number, max_size)
    return round(sum(sizes.values()))


def check_memory(pid: int, inherited_bytes: int, megabytes: float) -> Excess | None:
    """Return an excess if the memory of all descendants of a process together exceeds a limit.

    The memory is the sum of the resident sets (RSS). The proportional sets (PSS) would count shared
    pages once, but only root may read them. A process that was just forked shares nearly all pages
    with its parent, so the pages of the template are subtracted from each, up to the pages that the
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
    """Yield the ids of all descendants of a process, or none on systems that do not list them."""
    for task in Path(f"/proc/{pid}/task").glob("*/children"):
        # The process may have just ended.
        with suppress(OSError):
            for child in map(int, task.read_text().split()):
                yield child
                yield from descendants(child)


MOUNTS, HOST_NAME, IPC, USER, PROCESSES, NETWORKS = (
    0x20000, 0x4000000, 0x8000000, 0x10000000, 0x20000000, 0x40000000
)  # fmt: skip
BIND, PRIVATE, RECURSIVE = 1 << 12, 1 << 18, 1 << 14
READ_ONLY, NO_SUID, NO_DEVICES = 1, 2, 4
DETACH = 2  # flag of umount2
MOUNT_SETATTR, AT_ROOT, AT_RECURSIVE = 442, -100, 0x8000
INODES = 4096  # maximum number of files in the scratch folder
COVERED, OLD = "/tmp", "/.old"  # folder of the new root, and temporary mount point of the old root
MEGABYTES = 64  # [MB] size limit of files that imports write before any submission runs


class _MountAttributes(ctypes.Structure):
    _fields_ = tuple((name, ctypes.c_uint64) for name in ("set", "clear", "propagation", "user"))


def enter_namespaces() -> None:
    """Enter new namespaces. The next fork is the first process of the new process tree.

    Raises:
        OSError: The system does not allow it.
    """
    kinds = MOUNTS | HOST_NAME | IPC | PROCESSES | NETWORKS
    try:
        # A user namespace also counts its own processes.
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
    _change_mounts("/", _MountAttributes(set=READ_ONLY | NO_SUID))  # files are read-only from here on
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
