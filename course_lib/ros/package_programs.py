"""Executables of packages, run as programs of a graph; also components in Python."""

import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.not_offered import not_offered
from course_lib.ros.packages import Package, find_package, is_compiled, python_path, why_not_found
from course_lib.ros.process import Function, Program

Executables = Mapping[tuple[str, str], Callable[[], object]]  # by package and name
_AS_EXECUTABLE = {  # components that the kit has as executables of their package
    "robot_state_publisher::RobotStatePublisher": "robot_state_publisher",
    "joint_state_publisher::JointStatePublisher": "joint_state_publisher",
}
_imported: set[str] = set()  # packages of processes; another launch reads their files again


class RunProgram(Function):
    """One executable of a package with its words, as `ros2 run` starts it."""

    def __init__(self, package: str, executable: str, words: Sequence[str], own: Executables) -> None:
        super().__init__(executable, find_executable(package, executable, own), words)

    def run(self) -> None:
        """Run it to its end, with ros2cli's line for a failure."""
        forget_imported()
        super().run()
        if self.exit_code:
            sys.stdout.write(f"[ros2run]: Process exited with failure {self.exit_code}\n")


def find_executable(package: str, executable: str, own: Executables) -> Callable[[], object]:
    """Find an executable of a package or of the kit; raises a CourseError that says what there is."""
    found = find_package(package)
    if found is not None and executable in found.executables:
        return partial(_call, found, executable)
    if (package, executable) in own:
        return own[package, executable]
    if found is not None and is_compiled(found, executable):
        raise CourseError(
            f"'{executable}' of package '{package}' is a compiled program, and this kit runs Python only. "
            "Build it with colcon on a computer with ROS 2, or write the node in Python."
        )
    names = [*(found.executables if found else ()), *(name for place, name in own if place == package)]
    if not names and found is None:
        raise CourseError(why_not_found(package))
    where = " Executables are named in console_scripts in setup.py." if found else ""
    raise CourseError(
        f"executable '{executable}' not found in package '{package}', which has: "
        f"{', '.join(names) or 'none'}{did_you_mean(executable, names) or '.'}{where}"
    )


def find_component(package: str, plugin: str, own: Executables) -> Callable[[], object]:
    """Find a component as a program; raises a CourseError where it is one of C++."""
    found = find_package(package)
    if found is not None and plugin in found.components:
        return partial(_spin_component, found, *found.components[plugin])
    if plugin in _AS_EXECUTABLE:
        return find_executable(package, _AS_EXECUTABLE[plugin], own)
    if why := not_offered(package):
        raise CourseError(f"component '{plugin}' is left out: {why}")
    raise CourseError(
        f"component '{plugin}' of package '{package}' is left out: it is a C++ plugin, and this kit runs "
        "Python only. Start a Python node in its place, or run it on a computer with ROS 2 and link to that: "
        "course run FILE --robot tcp/HOST:7447"
    )


def forget_imported() -> None:
    """Unload the packages of earlier processes: their files may have changed."""
    for name in [name for name in sys.modules if name.partition(".")[0] in _imported]:
        del sys.modules[name]
    _imported.clear()


def put_first(folders: Sequence[str]) -> None:
    """Look for modules in folders of packages first, behind the stand-in; another launch reads them again."""
    sys.path[1:] = [*folders, *(entry for entry in sys.path[1:] if entry not in folders)]
    packages = [Path(folder) for folder in folders if (Path(folder) / "package.xml").is_file()]
    _imported.update(path.parent.name for package in packages for path in package.glob("*/__init__.py"))


def _call(package: Package, executable: str) -> object:
    _put_on_path(package)
    target = package.executables[executable]
    if isinstance(target, Path):
        Program(target, ()).work()
        return None
    return _imported_name(*target)()


def _spin_component(package: Package, module: str, name: str) -> None:
    """Spin a node of a component's class, as a container does."""
    import rclpy
    from rclpy.executors import ExternalShutdownException

    _put_on_path(package)
    rclpy.init()
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(_imported_name(module, name)())


def _put_on_path(package: Package) -> None:
    """Prepare the calling program to import a package and those beside it, behind the stand-in."""
    put_first([str(folder) for folder in package.python])
    sys.path += [place for place in python_path(package.share / "package.xml") if place not in sys.path]


def _imported_name(module: str, name: str) -> Any:
    _imported.add(module.partition(".")[0])
    return getattr(import_module(module), name)
