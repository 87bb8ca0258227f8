"""The files of the distributions that the kit declares in its metadata, and of those that these need."""

import sys
from collections.abc import Iterator, Sequence
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path

from course_lib.errors import CourseError

KIT = "course-lib"
CACHE = "__pycache__"


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

    seen, waiting = set[tuple[str, frozenset[str]]](), [Requirement(KIT)]
    while waiting:
        need = waiting.pop()
        key = (need.name.lower(), frozenset(need.extras))
        if key in seen:
            continue
        seen.add(key)
        try:
            found = distribution(need.name)
        except PackageNotFoundError as error:
            if need.name == KIT:
                problem = f"{KIT} is not installed for {sys.executable}. In its checkout: pip install -e ."
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
