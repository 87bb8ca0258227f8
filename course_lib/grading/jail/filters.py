"""Filters of the kernel: which files can be opened (Landlock) and which calls are refused (seccomp)."""

import ctypes
import errno
import os
import platform
import struct
from collections.abc import Mapping, Sequence

from course_lib.grading.jail.system_calls import NO_NEW_PRIVILEGES, function, prctl, syscall

CREATE, ADD_RULE, RESTRICT = 444, 445, 446  # numbers of the system calls
VERSION, PATH_BENEATH = 1, 1
EXECUTE, WRITE_FILE, READ_FILE, READ_DIR, TRUNCATE = 1 << 0, 1 << 1, 1 << 2, 1 << 3, 1 << 14
OF_FILES = EXECUTE | WRITE_FILE | READ_FILE | TRUNCATE
FILE_RIGHTS = {1: 13, 2: 14, 3: 15, 4: 15}  # how many there are, by version; 16 from the fifth on
TCP_RIGHTS, SCOPES = 0b11, 0b11  # TCP bind and connect; abstract sockets and signals
TCP_FROM, SIGNALS_FROM = 4, 6  # versions
SET_SECCOMP, MODE_FILTER = 22, 2
MACHINES = {"x86_64": (0, 0xC000003E), "aarch64": (1, 0xC00000B7)}  # column below, audit number
NEWER = 450  # calls that came later are as good as missing
X32 = 0x40000000  # the same calls under other numbers
REFUSED = {
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
    "ioperm": (173, None), "iopl": (172, None), "modify_ldt": (154, None),
}  # fmt: skip
NETWORK = {"socket": (41, 198)}  # a pair of sockets is no network, and asyncio needs one
PRETENDED = {  # does nothing, and says that it worked: who copies a file calls these, Landlock lets them pass
    "chmod": (90, None), "fchmod": (91, 52), "fchmodat": (268, 53),
    "chown": (92, None), "fchown": (93, 55), "lchown": (94, None), "fchownat": (260, 54),
    "utime": (132, None), "utimes": (235, None), "futimesat": (261, None), "utimensat": (280, 88),
    "setxattr": (188, 5), "lsetxattr": (189, 6), "fsetxattr": (190, 7),
    "removexattr": (197, 14), "lremovexattr": (198, 15), "fremovexattr": (199, 16),
}  # fmt: skip
LOAD, IF_EQUAL, IF_AT_LEAST, IF_ANY_BIT, RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
CLONE, CLONE3 = (56, 220), (435, 435)
BY_ARGUMENT = (  # refused if one of the tests of that argument, counted from 0, is met
    (CLONE, 0, IF_ANY_BIT, (0x7E020080,)),  # new namespaces
    # Which process: 0 is the caller. prlimit64, sched_setaffinity, _setscheduler, _setparam, _setattr
    *((call, 0, IF_AT_LEAST, (1,)) for call in ((302, 261), (203, 122), (144, 119), (142, 118), (314, 274))),
    ((72, 25), 1, IF_EQUAL, (8, 10, 15)),  # fcntl: F_SETOWN, _SETSIG, _SETOWN_EX have the kernel send signals
    ((16, 29), 1, IF_EQUAL, (0x8901, 0x8902, 0x5412)),  # ioctl: the same, and TIOCSTI types into a terminal
    ((53, 199), 1, IF_ANY_BIT, (2,)),  # socketpair: datagrams can be sent to any other socket
)
ALLOW, KILL, ERROR = 0x7FFF0000, 0x80000000, 0x00050000
NUMBER, MACHINE, ARGUMENTS = 0, 4, 16  # offsets in what the filter looks at; arguments have 8 bytes each


class _Ruleset(ctypes.Structure):
    _fields_ = (("files", ctypes.c_uint64), ("network", ctypes.c_uint64), ("scoped", ctypes.c_uint64))


class _PathBeneath(ctypes.Structure):
    _pack_ = 1
    _layout_ = "ms"
    _fields_ = (("allowed", ctypes.c_uint64), ("parent", ctypes.c_int32))


def version() -> int:
    """Return the version of the kernel's Landlock; 0 if it has none."""
    try:
        return syscall(CREATE, None, ctypes.c_size_t(0), VERSION)
    except OSError:
        return 0


def restrict_files(read: Sequence[str], write: Sequence[str], listed: Sequence[str] = ()) -> None:
    """Restrict this process and its children, for good, to opening these files; missing ones are skipped.

    Args:
        read: Files, and folders with all that is in them.
        write: The same, for any use but to execute.
        listed: Folders of which only the names of what is in them can be read.

    Raises:
        OSError: The kernel has no Landlock, or refuses.
    """
    has = version()
    every = (1 << FILE_RIGHTS.get(has, 16)) - 1
    rules = _Ruleset(every, TCP_RIGHTS if has >= TCP_FROM else 0, SCOPES if has >= SIGNALS_FROM else 0)
    size = ctypes.c_size_t(24 if has >= SIGNALS_FROM else 16 if has >= TCP_FROM else 8)  # [B], as it grew
    ruleset = syscall(CREATE, ctypes.byref(rules), size, 0)
    granted = ((read, EXECUTE | READ_FILE | READ_DIR), (write, every & ~EXECUTE), (listed, READ_DIR))
    for paths, rights in granted:
        for path in paths:
            if os.path.exists(path):
                _allow(ruleset, path, rights & every)
    prctl(NO_NEW_PRIVILEGES, 1)
    syscall(RESTRICT, ruleset, 0)
    os.close(ruleset)


def _allow(ruleset: int, path: str, rights: int) -> None:
    parent = os.open(path, os.O_PATH | os.O_CLOEXEC)
    rule = _PathBeneath(rights if os.path.isdir(path) else rights & OF_FILES, parent)
    syscall(ADD_RULE, ruleset, PATH_BENEATH, ctypes.byref(rule), 0)
    os.close(parent)


class _FilterProgram(ctypes.Structure):
    _fields_ = (("length", ctypes.c_ushort), ("code", ctypes.c_void_p))


def is_known() -> bool:
    """Return whether the tables hold the numbers of this machine's calls."""
    return platform.machine() in MACHINES


def refuse_calls() -> None:
    """Load the filter, for good, into this process and its children.

    Raises:
        OSError: The kernel refuses.
    """
    code = program(*MACHINES[platform.machine()])
    buffer = ctypes.create_string_buffer(code, len(code))
    loaded = _FilterProgram(len(code) // 8, ctypes.addressof(buffer))
    prctl(NO_NEW_PRIVILEGES, 1)
    function("prctl", SET_SECCOMP, MODE_FILTER, ctypes.byref(loaded), 0, 0)


def program(column: int, machine: int) -> bytes:
    """Return the filter's code: pairs of a test and its action."""

    def numbers(table: Mapping[str, tuple[int, int | None]]) -> list[int]:
        return [number for row in table.values() if (number := row[column]) is not None]

    steps = [
        _step(LOAD, MACHINE), _step(IF_EQUAL, machine, 1, 0), _step(RETURN, KILL),
        _step(LOAD, NUMBER), *_if(IF_AT_LEAST, X32, KILL), *_if(IF_AT_LEAST, NEWER, ERROR | errno.ENOSYS),
        # Threads start by clone then, whose flags can be looked at:
        *_if(IF_EQUAL, CLONE3[column], ERROR | errno.ENOSYS),
    ]  # fmt: skip
    for table, error in ((REFUSED, errno.EPERM), (NETWORK, errno.ENETDOWN), (PRETENDED, 0)):
        for number in numbers(table):
            steps += _if(IF_EQUAL, number, ERROR | error)
    for call, argument, test, values in BY_ARGUMENT:
        refusals = [step for value in values for step in _if(test, value, ERROR | errno.EPERM)]
        steps += [_step(IF_EQUAL, call[column], 0, len(refusals) + 2), _step(LOAD, ARGUMENTS + 8 * argument)]
        steps += [*refusals, _step(RETURN, ALLOW)]
    return b"".join([*steps, _step(RETURN, ALLOW)])


def _step(code: int, value: int, if_true: int = 0, if_false: int = 0) -> bytes:
    return struct.pack("HBBI", code, if_true, if_false, value)


def _if(test: int, value: int, action: int) -> list[bytes]:
    return [_step(test, value, 0, 1), _step(RETURN, action)]
