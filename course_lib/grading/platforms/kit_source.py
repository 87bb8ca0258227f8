"""The kit for an autograder of a course of one's own: its files, or what installs the same version."""

import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit
from urllib.request import url2pathname

from course_lib.course.installation import DISTRIBUTION
from course_lib.errors import CourseError
from course_lib.foreign import read_json

PROJECT = ("pyproject.toml", "README.md", "LICENSE")
PACKAGE = "course_lib"
MATERIAL = (PACKAGE, "notebooks", "exercises")  # what its build needs; all of it is public
FOLDER = "kit"  # beside the course, in the zip


@dataclass(frozen=True)
class KitSource:
    """The way in which setup.sh gets the kit.

    Args:
        words: For `pip install`, in the shell's spelling; `$root` is the folder of the autograder.
        name: For people.
        files: Those of the kit in the zip, by name.
    """

    words: str
    name: str
    files: Mapping[str, bytes] = field(default_factory=dict)


def kit_source(distribution: metadata.Distribution | None = None) -> KitSource:
    """Return the source of the installed kit: a checkout, a wheel, a repository, or its version of the index.

    Args:
        distribution: Default: the installed one.

    Raises:
        CourseError: It was installed from files that are not there any more.
    """
    installed = distribution or metadata.distribution(DISTRIBUTION)
    text = installed.read_text("direct_url.json")  # as PEP 610 has it; without it an index gave the kit
    if text is None:
        requirement = f"{DISTRIBUTION}=={installed.version}"
        return KitSource(requirement, f"{requirement} of the package index")
    direct: dict[str, Any] = read_json(text)
    url = str(direct["url"])
    if "vcs_info" in direct:
        version = direct["vcs_info"]
        return _from_url(f"{version['vcs']}+{url}@{version['commit_id']}")
    parts = urlsplit(url)
    if parts.scheme != "file":
        return _from_url(url)
    return _packed(Path(url2pathname(parts.path)), url)


def kit_files(root: Path) -> dict[str, bytes]:
    """Return the files of the kit in a checkout, by their paths."""
    paths = [root / name for name in PROJECT if (root / name).is_file()]
    found = (path for top in MATERIAL for path in (root / top).rglob("*"))
    paths += sorted(path for path in found if belongs(path.relative_to(root)))
    return {path.relative_to(root).as_posix(): path.read_bytes() for path in paths if path.is_file()}


def belongs(path: Path) -> bool:
    """Return whether a file of a project is a source, and no trace of running it."""
    return not any(part in ("__pycache__", "_course") or part.startswith(".") for part in path.parts)


def _from_url(url: str) -> KitSource:
    requirement = f"{DISTRIBUTION} @ {url}"
    return KitSource(shlex.quote(requirement), requirement)


def _packed(path: Path, url: str) -> KitSource:
    if (path / PACKAGE).is_dir():
        files = {f"{FOLDER}/{name}": data for name, data in kit_files(path).items()}
        return KitSource(f'-e "$root/source/{FOLDER}"', f"the kit's {len(files)} files", files)
    if path.is_file():
        name = f"{FOLDER}/{path.name}"
        return KitSource(f'"$root/source/{name}"', path.name, {name: path.read_bytes()})
    raise CourseError(
        f"the kit was installed from {url}, which is not there any more. Install it again, from a checkout, "
        "a wheel or the package index, then build the autograder"
    )
