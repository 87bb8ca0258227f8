"""Files that a robot description names."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import unquote, urlparse

from course_lib.errors import CourseError

_schemes = ["package", "file"]


@contextmanager
def packages_only() -> Iterator[None]:
    """Refuse ``file://`` and paths outside of packages within a `with` block, for untrusted addresses."""
    _schemes.remove("file")
    try:
        yield
    finally:
        _schemes.append("file")


def resolve(uri: str, near: Path | None = None) -> Path:
    """Return the file of a ``package://`` or ``file://`` address; `near` is the file that names it.

    Raises:
        CourseError: If it is no such address, or no file is there.
    """
    parts = urlparse(uri)
    inside = unquote(parts.path).lstrip("/")
    leads_out = "file" not in _schemes and ".." in Path(parts.netloc, inside).parts
    if parts.scheme not in _schemes or leads_out:
        raise CourseError(
            f"{uri!r} is not the address of a file; write package://PACKAGE/PATH or file:///PATH."
        )
    roots = package_roots(near) if parts.scheme == "package" else [Path("/")]
    found = next((path for root in roots if (path := root / parts.netloc / inside).is_file()), None)
    if found is None:
        raise CourseError(
            f"There is no file {uri}; correct the address, or put the folder that holds the package on "
            "ROS_PACKAGE_PATH."
        )
    return found


def package_roots(near: Path | None = None) -> list[Path]:
    """Return the folders that packages are searched in.

    They are those on ROS_PACKAGE_PATH, the robot data that comes with the kit, and those above `near`.
    """
    named = [Path(root) for root in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if root]
    return named + _installed() + (list(near.resolve().parents[1:]) if near else [])


def is_installed(file: Path) -> bool:
    """Return whether a file is of the robot data that comes with the kit."""
    return any(file.is_relative_to(root) for root in _installed())


def _installed() -> list[Path]:
    return [Path(entry) / "cmeel.prefix" / "share" for entry in sys.path if entry]
