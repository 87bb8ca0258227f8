"""The layers of the jail: which of them work here, and going into all that do."""

import os
import platform
import resource
import tempfile
from collections.abc import Callable, Collection
from contextlib import suppress

from course_lib.course.course_file import Limits
from course_lib.grading.jail import filters, limits, namespaces
from course_lib.grading.jail.place import DEVICES, HOMES, Place, works
from course_lib.grading.jail.system_calls import DUMPABLE, NO_NEW_PRIVILEGES, drop_capabilities, prctl


def working_layers(place: Place, off: Collection[str]) -> list[str]:
    """Return the layers that work here, but those that are off: each is tried in a fork, not looked up."""
    layers = ["bubblewrap"] if place.root == "bubblewrap" else []
    tries: dict[str, Callable[[], None]] = {
        "namespaces": lambda: _own_namespaces(place, Limits()),
        "Landlock": lambda: _only_files(place, place.scratch),
        "seccomp": filters.refuse_calls,
        "limits": lambda: limits.apply(Limits(), counts_from_zero=False),
    }
    if place.root == "host":  # which namespaces alone do not hide
        del tries["namespaces"]
    layers += [name for name, layer in tries.items() if name not in off and works(layer)]
    is_bounded = "limits" in layers and "process limit" not in off and platform.system() == "Linux"
    if is_bounded and works(lambda: _count_processes(place, layers)):  # not those of the real root
        layers.append("process limit")
    return layers


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
        counts_from_zero = "namespaces" in layers or place.user != "same"
        limits.apply(given, counts_from_zero=counts_from_zero)
    if platform.system() == "Linux":
        with suppress(OSError):  # one more wall where it works
            drop_capabilities()
            prctl(DUMPABLE, 0)
            prctl(NO_NEW_PRIVILEGES, 1)
    if "Landlock" in layers:
        _only_files(place, folder)
    if "seccomp" in layers:
        filters.refuse_calls()


def _own_namespaces(place: Place, given: Limits) -> None:
    namespaces.enter()
    first = os.fork()
    if first:
        os._exit(0)
    namespaces.own_files(place.scratch, given.scratch_megabytes)


def _only_files(place: Place, folder: str) -> None:
    filters.restrict_files([*place.read, *DEVICES], [folder, os.devnull], place.listed)


def _count_processes(place: Place, layers: Collection[str]) -> None:
    """Raise OSError unless a limit of processes holds here."""
    enter(place, {"namespaces"} & set(layers), Limits())
    resource.setrlimit(resource.RLIMIT_NPROC, (0, 0))
    try:
        child = os.fork()
    except BlockingIOError:
        return
    if child == 0:
        os._exit(0)
    raise OSError("the kernel does not count this user's processes")
