"""Landlock: which files this process and its children can still open, for good. Source: landlock(7)."""

import ctypes
import os
from collections.abc import Sequence

from course_lib.grading.jail.system_calls import NO_NEW_PRIVILEGES, prctl, syscall

CREATE, ADD_RULE, RESTRICT = 444, 445, 446  # numbers of the system calls
VERSION, PATH_BENEATH = 1, 1
EXECUTE, WRITE_FILE, READ_FILE, READ_DIR, TRUNCATE = 1 << 0, 1 << 1, 1 << 2, 1 << 3, 1 << 14
OF_FILES = EXECUTE | WRITE_FILE | READ_FILE | TRUNCATE
FILE_RIGHTS = {1: 13, 2: 14, 3: 15, 4: 15}  # how many there are, by version; 16 from the fifth on
NETWORK, SCOPES = 0b11, 0b11  # TCP bind and connect; abstract sockets and signals
TCP_FROM, SIGNALS_FROM = 4, 6  # versions


class _Ruleset(ctypes.Structure):
    _fields_ = (("files", ctypes.c_uint64), ("network", ctypes.c_uint64), ("scoped", ctypes.c_uint64))


class _PathBeneath(ctypes.Structure):
    _pack_ = 1
    _layout_ = "ms"
    _fields_ = (("allowed", ctypes.c_uint64), ("parent", ctypes.c_int32))


def version() -> int:
    """Which Landlock the kernel has; 0 if none."""
    try:
        return syscall(CREATE, None, ctypes.c_size_t(0), VERSION)
    except OSError:
        return 0


def restrict(read: Sequence[str], write: Sequence[str], listed: Sequence[str] = ()) -> None:
    """From now on only these files and folders can be opened; those that are missing are left out.

    Args:
        read: Files, and folders with all that is in them.
        write: The same, for any use but to execute.
        listed: Folders of which only the names of what is in them can be read.

    Raises:
        OSError: The kernel has no Landlock, or refuses.
    """
    has = version()
    every = (1 << FILE_RIGHTS.get(has, 16)) - 1
    rules = _Ruleset(every, NETWORK if has >= TCP_FROM else 0, SCOPES if has >= SIGNALS_FROM else 0)
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
