"""System calls of Linux that Python does not offer."""

import ctypes
import os
from functools import cache
from typing import Any

NO_NEW_PRIVILEGES, DUMPABLE, CHILD_SUBREAPER = 38, 4, 36  # operations of prctl
CAPABILITIES_3 = 0x20080522  # the version of the structure


@cache
def _libc() -> Any:
    library = ctypes.CDLL(None, use_errno=True)
    library.syscall.restype = ctypes.c_long
    return library


def function(name: str, *arguments: Any) -> int:
    """Call a function of the C library.

    Raises:
        OSError: It failed, or there is no such function here.
    """
    called = getattr(_libc(), name, None)
    if called is None:
        raise OSError(f"{name}: not on this system")
    result = int(called(*arguments))
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, f"{name}: {os.strerror(number)}")
    return result


def syscall(number: int, *arguments: Any) -> int:
    """Call the kernel by a number that is the same on all machines; errors as in `function`."""
    return function("syscall", ctypes.c_long(number), *arguments)


def prctl(operation: int, *arguments: int) -> None:
    """Change something of this process; errors as in `function`."""
    function("prctl", operation, *map(ctypes.c_ulong, (*arguments, 0, 0, 0, 0)[:4]))


def drop_capabilities() -> None:
    """Give up what a namespace's own root may do; errors as in `function`."""
    header = (ctypes.c_uint32 * 2)(CAPABILITIES_3, 0)
    function("capset", ctypes.byref(header), ctypes.byref((ctypes.c_uint32 * 6)()))
