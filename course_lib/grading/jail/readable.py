"""Files that a submission may read: those of the interpreter, the declared distributions and the kit."""

import glob
import os
import site
import sys
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path

import course_lib
from course_lib.errors import CourseError

DISTRIBUTION = "course-lib"
CACHE = "__pycache__"
KIT = os.path.dirname(os.path.realpath(course_lib.__file__))
HANDED_OUT = os.path.join(KIT, "_course")  # lessons, exercises and their checks, in an installed wheel
PACKAGE_FOLDERS = ("site-packages", "dist-packages")  # of which only declared distributions are readable
SYSTEM = (  # what programs look for on every machine: shared libraries, fonts, time zones
    "/etc/ld.so.cache", "/etc/alternatives", "/etc/localtime", "/etc/fonts",
    "/usr/share/fonts", "/usr/local/share/fonts", "/usr/share/fontconfig", "/usr/share/zoneinfo",
    "/usr/lib/locale", "/lib64", "/usr/lib64", "/lib/*-linux-*", "/usr/lib/*-linux-*",
    "/lib/*.so*", "/usr/lib/*.so*", "/usr/local/lib/*.so*",
)  # fmt: skip


def distribution_files() -> Iterator[str]:
    """Yield the files and folders at the top of each declared distribution, without its scripts.

    Raises:
        CourseError: The kit itself is not installed.
    """
    for found in _declared():
        folder = Path(str(found.locate_file("")))
        names = _recorded(found)
        if not names - {_metadata_folder(found)} - _paths_files(names):  # not recorded, or installed with -e
            names |= set((found.read_text("top_level.txt") or "").split())
            yield from _located(found.metadata["Name"].replace("-", "_"))
        for name in names:
            yield str(folder / name)
            yield str(folder / f"{name}.py")  # where top_level.txt names a module


def _declared() -> Iterator[Distribution]:
    """Yield the kit's distribution and what it requires here, at any depth; what is missing is left out."""
    from packaging.requirements import Requirement

    seen, waiting = set[tuple[str, frozenset[str]]](), [Requirement(DISTRIBUTION)]
    while waiting:
        need = waiting.pop()
        key = (need.name.lower(), frozenset(need.extras))
        if key in seen:
            continue
        seen.add(key)
        try:
            found = distribution(need.name)
        except PackageNotFoundError as error:
            if need.name == DISTRIBUTION:
                problem = (
                    f"{DISTRIBUTION} is not installed for {sys.executable}. In its checkout: pip install -e ."
                )
                raise CourseError(problem) from error
            continue
        yield found
        extras = need.extras or {""}
        waiting += [
            more for more in map(Requirement, _requirements(found))
            if more.marker is None or any(more.marker.evaluate({"extra": extra}) for extra in extras)
        ]  # fmt: skip


def _requirements(found: Distribution) -> Sequence[str]:
    """Return what a distribution requires, without parsing its long description, which is slow."""
    head, _, _ = (found.read_text("METADATA") or "").partition("\n\n")
    if not head:
        return found.requires or ()
    key = "Requires-Dist:"
    return [line.removeprefix(key).strip() for line in head.splitlines() if line.startswith(key)]


def _recorded(found: Distribution) -> set[str]:
    """Return the first parts of all recorded paths, and whole paths in the cache that modules share."""
    names = {_metadata_folder(found)}
    for line in (found.read_text("RECORD") or "").splitlines():
        path = line.strip('"').split(",", 1)[0]
        first = path.split("/", 1)[0]
        if first not in ("", "..") and not path.startswith("/"):
            names.add(path if first == CACHE else first)
    return names


def _metadata_folder(found: Distribution) -> str:
    return Path(str(getattr(found, "_path", ""))).name  # importlib.metadata has no public name for it


def _paths_files(names: set[str]) -> set[str]:
    return {name for name in names if name.endswith(".pth")}


def _located(name: str) -> Iterator[str]:
    """Yield where a module or package of that name is imported from."""
    spec = find_spec(name)
    if spec is not None:
        yield from spec.submodule_search_locations or ()
        yield from [spec.origin] if spec.origin and not spec.submodule_search_locations else []


@dataclass(frozen=True)
class Readable:
    """Files and folders that a submission may read; no refused path is in one of them.

    Args:
        paths: Where they really are; folders with all that is in them.
        links: Symbolic links on the way to them, with their targets.
        listed: Folders of which the names may be read, as the import system does.
        torn: A path of the course inside of one that is needed; empty if there is none.
    """

    paths: tuple[str, ...]
    links: tuple[tuple[str, str], ...] = ()
    listed: tuple[str, ...] = ()
    torn: str = ""


@cache
def readable(refused: tuple[str, ...] = ()) -> Readable:
    """Return what submissions may read on this machine.

    Args:
        refused: Paths of the course that they may not, even inside of what is needed.

    Raises:
        CourseError: Something that is needed is itself refused.
    """
    folders, needed = _needed()
    return allow(needed, folders, refused)


@cache
def _needed() -> tuple[list[str], list[str]]:
    """Return where modules are looked for, and with that all that is needed, whatever is refused."""
    folders = _module_folders()
    return folders, [*_system(), *_interpreter(), *folders, *distribution_files(), KIT]


def allow(needed: Iterable[str], folders: Collection[str], refused: Collection[str]) -> Readable:
    """Return what is readable of the files and folders that are needed.

    Args:
        needed: Whole, but for the other arguments.
        folders: Where modules are looked for; of those that hold packages only what is needed for itself.
        refused: Paths of the course.

    Raises:
        CourseError: Something that is needed is itself refused.
    """
    wanted = [path for path in dict.fromkeys(needed) if os.path.exists(path)]
    course = [path for path in map(os.path.realpath, refused) if not _holds(HANDED_OUT, path)]
    shared = _shared(folders)
    handed_out = [HANDED_OUT] * os.path.exists(HANDED_OUT)
    paths, torn = set[str](), ""
    for path in map(os.path.realpath, wanted):
        if path in course:
            raise CourseError(f"submissions must not read {path}, and Python needs it to run them: move it")
        torn = next((one for one in course if _holds(path, one) and path not in shared), torn)
        is_package = any(_holds(folder, path) and folder != path for folder in shared)
        paths.update(_without(path, [*course, *handed_out, *([] if is_package else shared)]))
    looked_in = map(os.path.realpath, [*folders, KIT])
    listed = [path for path in looked_in if not any(_holds(path, one) for one in course)]
    links = dict(link for path in wanted for link in links_on(path))
    links |= {path: os.readlink(path) for path in paths if os.path.islink(path)}  # and not where they lead
    return Readable(tuple(_outermost(paths - links.keys())), tuple(links.items()), tuple(listed), torn)


def links_on(path: str) -> Iterator[tuple[str, str]]:
    """Yield the symbolic links on the way to an existing path, with their targets."""
    done, rest = "/", path.split("/")
    while rest:
        name = rest.pop(0)
        done = os.path.normpath(os.path.join(done, name))
        if os.path.islink(done):
            target = os.readlink(done)
            yield done, target
            done, rest = os.path.dirname(done), [*target.split("/"), *rest]
            done = "/" if target.startswith("/") else done


def _system() -> Iterator[str]:
    for pattern in SYSTEM:
        yield from glob.iglob(pattern)
    with suppress(OSError):  # not Linux
        mapped = Path("/proc/self/maps").read_text(errors="surrogateescape").splitlines()
        yield from (line[line.index("/") :] for line in mapped if "/" in line and ".so" in line)


def _interpreter() -> Iterator[str]:
    yield sys.executable
    yield os.path.join(sys.prefix, "pyvenv.cfg")
    for prefix in {sys.prefix, sys.base_prefix, sys.base_exec_prefix}:
        yield from glob.iglob(os.path.join(glob.escape(prefix), "lib", "*.so*"))


def _module_folders() -> list[str]:
    """Return where Python looks for its own modules and for packages."""
    found = [*site.getsitepackages(), site.getusersitepackages(), *sys.path]
    named = [path for path in found if os.path.basename(path) in ("lib-dynload", *PACKAGE_FOLDERS)]
    return list(filter(os.path.isdir, dict.fromkeys([os.path.dirname(os.__file__), *named])))


def _shared(folders: Collection[str]) -> list[str]:
    """Return folders with packages that need not be the kit's, also those of other interpreters."""
    inside = [os.path.join(folder, name) for folder in folders for name in PACKAGE_FOLDERS]
    others = glob.glob("/usr/lib*/python*/*-packages")
    named = [path for path in folders if os.path.basename(path) in PACKAGE_FOLDERS]
    return [os.path.realpath(path) for path in (*named, *inside, *others)]


def _holds(folder: str, path: str) -> bool:
    return path == folder or path.startswith(folder.rstrip("/") + "/")


def _without(path: str, refused: Collection[str]) -> list[str]:
    """Return the path, or where it holds refused ones what lies around them."""
    if path in refused:
        return []
    if not any(_holds(path, one) for one in refused):
        return [path]
    return [kept for name in os.listdir(path) for kept in _without(os.path.join(path, name), refused)]


def _outermost(paths: Iterable[str]) -> Iterator[str]:
    last = ""
    for path in sorted(paths, key=lambda path: path.split("/")):
        if not (last and _holds(last, path)):
            last = path
            yield path
