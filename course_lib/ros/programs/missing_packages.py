"""Packages that a launch file uses but that are not installed here; the launch continues without them.

Most public launch files start a simulator, drivers or controllers along with programs that can run
here. While a launch file is read, the share folder of a missing package is the path that it has on
a robot. An action that then uses the path is skipped with one line in the log, and all other
actions start.
"""

import re
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path

from course_lib.errors import CourseError

INSTALLED = Path("/opt/ros/jazzy/share")
_absent: ContextVar[dict[str, str] | None] = ContextVar("absent", default=None)


class NotHereError(CourseError):
    """A part of ROS cannot run here, because a package is missing or a program is compiled."""


@contextmanager
def tolerate_missing(absent: dict[str, str] | None) -> Iterator[None]:
    """Tolerate missing packages within a `with` block and add their names and reasons to `absent`.

    With None, missing packages are errors.
    """
    token = _absent.set(absent)
    try:
        yield
    finally:
        _absent.reset(token)


def is_tolerant() -> bool:
    """Return whether missing packages are tolerated."""
    return _absent.get() is not None


def missing_share_folder(package: str, reason: str) -> Path | None:
    """Return the share folder that a missing package has on a robot, or None if it is an error."""
    absent = _absent.get()
    if absent is None:
        return None
    absent[package] = reason
    return INSTALLED / package


def reason_in(text: str) -> str:
    """Return the reason for the first missing package whose path occurs in a string, or ""."""
    for name in re.findall(rf"{INSTALLED}/([\w.-]+)", text):
        reason = (_absent.get() or {}).get(name)
        if reason:
            return reason
    return ""


_ELSEWHERE = "or run it on a computer with ROS 2 and link to that: course run FILE --robot dds/HOST"
_TABLE = Path(__file__).parents[1] / "not_offered.toml"
_ENTRIES = tomllib.loads(_TABLE.read_text(encoding="utf-8"))
_PROJECTS, _SOURCES = _ENTRIES["project"], _ENTRIES["source"]


def unavailable_reason(package: str) -> str:
    """Return why a package is not available and what to do instead; "" for all other packages."""
    for project in _PROJECTS:
        if re.fullmatch(project["names"], package):
            return f"{project['reason']}, which pip can't install. Here {project['instead']}; {_ELSEWHERE}."
    return ""


def clone_instructions(package: str) -> str:
    """Return instructions to clone a Python package that is not on PyPI, or ""."""
    if package not in _SOURCES:
        return ""
    return f"it is a source package: clone it into the workspace's src, with git clone {_SOURCES[package]}"
