"""The import path: a program gets the stand-in, whatever other ROS is installed."""

import os
import sys
from collections.abc import Iterator, Sequence
from functools import cache, partial
from importlib import import_module
from importlib.abc import Loader
from importlib.machinery import ModuleSpec
from importlib.util import spec_from_loader
from pathlib import Path
from types import ModuleType

from course_lib.errors import CourseError
from course_lib.ros.homes import Homes

STANDIN = Path(__file__).parent / "standin"
SOURCED = {"ROS_DISTRO": "jazzy", "ROS_VERSION": "2", "ROS_PYTHON_VERSION": "3"}  # by setup.bash, in ROS
KINDS = ("msg", "srv", "action")


def install() -> None:
    """Put the stand-in's packages first on sys.path; raises a CourseError if others of a name are in use.

    ROS's variables are set, too, where they are not.
    """
    ours = str(STANDIN)
    for name in provided():
        module = sys.modules.get(name)
        if module is not None and not _origin(module).startswith(f"{ours}{os.sep}"):
            raise CourseError(
                f"{name} has already been imported from {_origin(module)}, so the course's own ROS can't "
                "take its place. Restart the kernel and load course_lib first: %load_ext course_lib"
            )
    for name, value in SOURCED.items():
        os.environ.setdefault(name, value)
    if sys.path[:1] != [ours]:
        sys.path[:] = [ours, *(entry for entry in sys.path if entry != ours)]
    if _Types not in sys.meta_path:
        sys.meta_path[:0] = [_Types, Homes]


class _Types(Loader):
    """Imports the types: `std_msgs`, `std_msgs.msg` and the like, or `my_msgs/msg/Name.msg` on the path."""

    @classmethod
    def find_spec(
        cls, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find a package that the kit has types of, or a folder that holds interface files."""
        package, _, kind = name.rpartition(".")
        if not package:
            return _package_of_types(name, cls())
        if kind not in KINDS or "." in package:
            return None
        for folder in _places(package, path or ()):
            if (
                _has_types(package, kind)
                if folder.parent == STANDIN
                else any(folder.glob(f"{kind}/*.{kind}"))
            ):
                return spec_from_loader(name, cls(), origin=str(folder))
        return None

    def exec_module(self, module: ModuleType) -> None:
        """Fill the module with the types; the package itself stays empty."""
        from course_lib.ros.messages.definitions import add_package
        from course_lib.ros.messages.registry import import_types

        if "." not in module.__name__:
            vars(module)["__getattr__"] = partial(_types_of_loaded, module.__name__)
            return
        folder = Path(str(module.__spec__ and module.__spec__.origin))
        if folder.parent != STANDIN:
            add_package(folder)
        vars(module).update(import_types(module.__name__))


def _places(package: str, path: Sequence[str]) -> Iterator[Path]:
    """List where a package may have its interface files: also beside its folder of Python."""
    for folder in map(Path, path):
        yield folder
        if folder.parent.name == package == folder.name and (folder.parent / "package.xml").is_file():
            yield folder.parent


def _types_of_loaded(package: str, name: str) -> ModuleType:
    """Return `std_msgs.msg` where a message of std_msgs was loaded before: then ROS has imported it, too."""
    from course_lib.ros.messages.registry import loaded

    if name not in KINDS or package not in loaded or not _has_types(package, name):
        raise AttributeError(f"module '{package}' has no attribute '{name}'")
    return import_module(f"{package}.{name}")


def _package_of_types(name: str, loader: Loader) -> ModuleSpec | None:
    """Find a package of which the build has written only stubs; it comes before any other of that name."""
    folder = STANDIN / name
    if not folder.is_dir() or (folder / "__init__.py").is_file():
        return None
    spec = ModuleSpec(name, loader, origin=str(folder), is_package=True)
    spec.submodule_search_locations = [str(folder)]
    return spec


def _has_types(package: str, kind: str) -> bool:
    from course_lib.ros.messages.definitions import type_names

    return any(name.startswith(f"{package}/{kind}/") for name in type_names())


@cache
def provided() -> list[str]:
    """List the packages that the stand-in provides."""
    code = {path.parent for path in STANDIN.glob("*/__init__.py")}
    types = {path.parents[1] for path in STANDIN.glob("*/*/__init__.pyi")}
    return sorted(folder.name for folder in code | types)


def _origin(module: ModuleType) -> str:
    """Return the place of a module: its file, or the folder of a package without one."""
    file = getattr(module, "__file__", None)
    return str(file or next(iter(getattr(module, "__path__", [])), "an unknown place"))
