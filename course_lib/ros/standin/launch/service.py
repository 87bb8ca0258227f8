"""LaunchService and LaunchIntrospector, which launch files use that are programs, too."""

from collections.abc import Iterable
from typing import Any

from course_lib.errors import CourseError
from launch.entities import LaunchDescription


class LaunchService:
    """A launch within a program; the kit runs launch files only."""

    def __init__(self, *, argv: Iterable[str] | None = None, **options: Any) -> None:
        self.descriptions: list[LaunchDescription] = []

    def include_launch_description(self, launch_description: LaunchDescription) -> None:
        """Add a description."""
        self.descriptions.append(launch_description)

    def run(self, *, shutdown_when_idle: bool = True) -> int:
        """Raise a CourseError that names the way to run the file."""
        raise CourseError(
            "LaunchService cannot run inside a program here. Return the LaunchDescription from "
            "generate_launch_description(), and run the file: course run FILE.launch.py"
        )


class LaunchIntrospector:
    """A writer of descriptions as text."""

    def format_launch_description(self, launch_description: LaunchDescription) -> str:
        """Return the kinds of a description's entities as a tree."""
        kinds = [type(entity).__name__ for entity in launch_description.entities]
        marks = ["├──"] * (len(kinds) - 1) + ["└──"]
        return "\n".join(
            [f"{launch_description}", *(f"{mark} {kind}" for mark, kind in zip(marks, kinds, strict=False))]
        )
