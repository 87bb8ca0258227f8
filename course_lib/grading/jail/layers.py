"""The layers of the jail: which of them work here, and going into all that do."""

import os
import platform
import tempfile
from collections.abc import Callable, Collection
from contextlib import suppress
from dataclasses import dataclass

from course_lib.course.course_file import Limits
from course_lib.grading.jail import landlock, limits, namespaces, seccomp
from course_lib.grading.jail.system_calls import DUMPABLE, NO_NEW_PRIVILEGES, drop_capabilities, prctl

DEVICES = ("/dev/null", "/dev/zero", "/dev/urandom", "/dev/random")
HOMES = ("HOME", "TMPDIR", "IPYTHONDIR", "MPLCONFIGDIR")


@dataclass(frozen=True)
class Place:
    """Where submissions run: a folder for what they write, and the files and folders that they may read."""

    scratch: str
    read: tuple[str, ...]


def working_layers(place: Place, off: Collection[str]) -> list[str]:
    """The layers that work here, but those that are off: each is tried in a fork, not looked up."""
    tries: dict[str, Callable[[], None]] = {
        "namespaces": lambda: _own_namespaces(place, Limits()),
        "Landlock": lambda: landlock.restrict(place.read, [place.scratch]),
        "seccomp": seccomp.restrict,
        "limits": lambda: limits.apply(Limits(), counts_from_zero=False),
    }
    layers = [name for name, layer in tries.items() if name not in off and _works(layer)]
    # The kernel counts no processes of the real root, and macOS bounds no memory:
    counted = "limits" in layers and os.getuid() != 0 and platform.system() == "Linux"
    return [*layers, *["process limit"] * (counted and "process limit" not in off)]


def enter(place: Place, layers: Collection[str], given: Limits) -> None:
    """Go into the jail for good; with namespaces only a fork of this process comes back from here.

    Raises:
        OSError: A layer that worked before does not.
    """
    folder = place.scratch
    if "namespaces" in layers:
        _own_namespaces(place, given)
    else:
        folder = tempfile.mkdtemp(dir=place.scratch)
    os.chdir(folder)
    os.environ.update(dict.fromkeys(HOMES, folder))
    if "limits" in layers:
        limits.apply(given, counts_from_zero="namespaces" in layers)
    if platform.system() == "Linux":
        with suppress(OSError):  # one more wall where it works
            drop_capabilities()
            prctl(DUMPABLE, 0)
            prctl(NO_NEW_PRIVILEGES, 1)
    if "Landlock" in layers:
        landlock.restrict([*place.read, *DEVICES], [folder])
    if "seccomp" in layers:
        seccomp.restrict()


def _own_namespaces(place: Place, given: Limits) -> None:
    namespaces.enter()
    first = os.fork()
    if first:
        os._exit(0)
    namespaces.own_files(place.scratch, given.scratch_megabytes)


def _works(layer: Callable[[], None]) -> bool:
    reader, writer = os.pipe()
    pid = os.fork()
    if pid == 0:
        with suppress(BaseException):
            layer()
            os.write(writer, b"y")
        os._exit(0)
    os.close(writer)
    worked = os.read(reader, 1) == b"y"  # from its fork, if it has one
    os.close(reader)
    os.waitpid(pid, 0)
    return worked
