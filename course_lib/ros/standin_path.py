"""Which ROS a program gets: the stand-in, whatever else is installed."""

import sys
from functools import cache
from pathlib import Path
from types import ModuleType

from course_lib.errors import CourseError

STANDIN = Path(__file__).parent / "standin"


def install() -> None:
    """Put the stand-in's packages first on sys.path, so that `import rclpy` and the like find them.

    Raises:
        CourseError: Another package of such a name is in use already.
    """
    for name in provided():
        module = sys.modules.get(name)
        if module is not None and not _is_ours(module):
            raise CourseError(
                f"{name} has already been imported from {_origin(module)}, so the course's own ROS can't "
                "take its place. Restart the kernel and load course_lib first: %load_ext course_lib"
            )
    ours = str(STANDIN)
    if sys.path[:1] != [ours]:
        sys.path[:] = [ours, *(entry for entry in sys.path if entry != ours)]


@cache
def provided() -> list[str]:
    """List the packages that the stand-in provides."""
    return sorted(path.parent.name for path in STANDIN.glob("*/__init__.py"))


def _is_ours(module: ModuleType) -> bool:
    return STANDIN in Path(_origin(module)).parents


def _origin(module: ModuleType) -> str:
    """Say where a module came from: its file, or the folder of a package without one."""
    file = getattr(module, "__file__", None)
    return str(file or next(iter(getattr(module, "__path__", [])), "an unknown place"))
