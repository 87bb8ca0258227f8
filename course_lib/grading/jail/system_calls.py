"""System calls of Linux that Python does not offer."""

import ctypes
import os
from functools import cache
from typing import Any

NO_NEW_PRIVILEGES, DUMPABLE, CHILD_SUBREAPER, KEEP_CAPABILITIES = 38, 4, 36, 8  # operations of prctl
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
    """Drop all capabilities, of root or of a namespace's own root; errors as in `function`."""
    _set_capabilities((ctypes.c_uint32 * 6)())


def use_capabilities() -> None:
    """Put all permitted capabilities into effect after a change of the user; errors as in `function`."""
    sets = (ctypes.c_uint32 * 6)()  # effective, permitted, inheritable, and the same of higher numbers
    function("capget", ctypes.byref((ctypes.c_uint32 * 2)(CAPABILITIES_3, 0)), ctypes.byref(sets))
    sets[0], sets[3] = sets[1], sets[4]
    _set_capabilities(sets)


def _set_capabilities(sets: Any) -> None:
    function("capset", ctypes.byref((ctypes.c_uint32 * 2)(CAPABILITIES_3, 0)), ctypes.byref(sets))
