"""Executables and Python components of packages, run as programs of a graph."""

import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError, did_you_mean, format_count, location_of
from course_lib.ros.programs.build_files import build_faults, malformed_script
from course_lib.ros.programs.packages import (
    NotAvailableError,
    Package,
    find_package,
    not_found_reason,
    python_path,
    unavailable_reason,
)
from course_lib.ros.programs.process import FunctionProcess, Program

# Functions by package and executable.
Executables = Mapping[tuple[str, str], Callable[[], object]]
# Components that the kit provides as executables of their package.
_AS_EXECUTABLE = {
    "robot_state_publisher::RobotStatePublisher": "robot_state_publisher",
    "joint_state_publisher::JointStatePublisher": "joint_state_publisher",
    "nav2_map_server::MapServer": "map_server",
    "nav2_map_server::MapSaver": "map_saver_server",
    "nav2_lifecycle_manager::LifecycleManager": "lifecycle_manager",
    "demo_nodes_cpp::Talker": "talker",
    "demo_nodes_cpp::Listener": "listener",
    "demo_nodes_cpp::ServerNode": "add_two_ints_server",
    "demo_nodes_cpp::ParameterBlackboard": "parameter_blackboard",
}
# Packages that processes have imported. The next launch reads their files again.
_imported: set[str] = set()
# Warnings about packages that were printed.
_warned: set[str] = set()


class RunProgram(FunctionProcess):
    """An executable of a package with its arguments, as `ros2 run` starts it."""

    def __init__(
        self,
        package: str,
        executable: str,
        args: Sequence[str],
        kit_executables: Executables,
    ) -> None:
        super().__init__(executable, find_executable(package, executable, kit_executables), args)

    def run(self) -> None:
        """Run the executable until it ends. Report a failure as ros2cli does."""
        unload_packages()
        super().run()
        if self.exit_code:
            sys.stdout.write(f"[ros2run]: Process exited with failure {self.exit_code}\n")


def find_executable(
    package: str,
    executable: str,
    kit_executables: Executables,
) -> Callable[[], object]:
    """Find an executable of a package or of the kit.

    Raise a CourseError that lists the executables.
    """
    package_found = find_package(package)
    if package_found is not None and executable in package_found.executables:
        _warn_of_faults(package_found)
        return partial(_call, package_found, executable)
    if (package, executable) in kit_executables:
        return kit_executables[package, executable]
    if package_found is not None and executable in package_found.compiled:
        raise NotAvailableError(
            f"'{executable}' of package '{package}' is a compiled program, and this kit runs "
            "Python only. Build it with colcon on a computer with ROS 2, or write the node in "
            "Python."
        )
    if package_found is None and (why := unavailable_reason(package)):
        is_partly_here = any(owner == package for owner, _ in kit_executables)
        subject = f"executable '{executable}' of package" if is_partly_here else "package"
        raise NotAvailableError(f"{subject} '{package}' not found: {why}")
    if (
        package_found is not None
        and not (package_found.executables or package_found.compiled)
        and (package_found.share / "CMakeLists.txt").is_file()
        and any(file.suffix in (".cpp", ".cc", ".cxx") for file in package_found.share.rglob("*.c*"))
    ):
        raise NotAvailableError(
            f"'{executable}' of package '{package_found.name}' cannot run here: the package has "
            "sources in C++ and "
            f"no Python executables. Its {package_found.share / 'CMakeLists.txt'} builds them "
            "with its own commands."
        )
    names = [
        *(package_found.executables if package_found else ()),
        *(name for owner, name in kit_executables if owner == package),
    ]
    if not names and package_found is None:
        raise NotAvailableError(not_found_reason(package, {owner for owner, _ in kit_executables}))
    advice = ""
    if package_found is not None:
        advice = malformed_script(package_found.share / "setup.py") or (
            " Executables are named in console_scripts in setup.py, or by install(PROGRAMS …) in "
            "CMakeLists.txt."
        )
    raise CourseError(
        f"executable '{executable}' not found in package '{package}', which has: "
        f"{', '.join(names) or 'none'}{did_you_mean(executable, names) or '.'}{advice}"
    )


def _warn_of_faults(package: Package) -> None:
    """Print why a package in its sources does not start on a robot, once for each state of its files."""
    faults = build_faults(package.name, package.share) if package.share.parent.name != "share" else []
    more = f" This and {format_count(len(faults) - 1, 'other fault')} are listed" if len(faults) > 1 else ""
    for fault in faults[:1]:
        warning = f"warning: package '{package.name}' starts here, but not on a robot: {fault}{more}"
        warning += f" by: course export --check {package.share}\n" if more else "\n"
        if warning not in _warned:
            _warned.add(warning)
            sys.stderr.write(warning)


def find_component(package: str, plugin: str, kit_executables: Executables) -> Callable[[], object]:
    """Find a component as a program. Raise a CourseError if it is a C++ component."""
    package_found = find_package(package)
    if package_found is not None and plugin in package_found.components:
        return partial(_spin_component, package_found, *package_found.components[plugin])
    if plugin in _AS_EXECUTABLE:
        return find_executable(package, _AS_EXECUTABLE[plugin], kit_executables)
    if why := unavailable_reason(package):
        raise CourseError(f"component '{plugin}' is left out: {why}")
    raise CourseError(
        f"component '{plugin}' of package '{package}' is left out: it is a C++ plugin, and this "
        "kit runs Python only. Start a Python node instead, or run the component on a computer "
        "with ROS 2 and link to it: course run FILE --robot dds/HOST"
    )


def unload_packages() -> None:
    """Unload the packages of earlier processes, because their files may have changed."""
    for name in [name for name in sys.modules if name.partition(".")[0] in _imported]:
        del sys.modules[name]
    _imported.clear()


def prepend_to_path(folders: Sequence[str]) -> None:
    """Put folders of packages first on sys.path, after the stand-in.

    The next launch reads them again.
    """
    sys.path[1:] = [*folders, *(entry for entry in sys.path[1:] if entry not in folders)]
    packages = [Path(folder) for folder in folders if (Path(folder) / "package.xml").is_file()]
    _imported.update(path.parent.name for package in packages for path in package.glob("*/__init__.py"))


def _call(package: Package, executable: str) -> object:
    _add_to_path(package)
    target = package.executables[executable]
    if isinstance(target, Path):
        Program(target, ()).work()
        return None
    return _imported_name(package, *target)()


def _spin_component(package: Package, module: str, name: str) -> None:
    """Spin a node of a component class, as a container does."""
    import rclpy
    from rclpy.executors import ExternalShutdownException

    _add_to_path(package)
    rclpy.init()
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(_imported_name(package, module, name)())


def _add_to_path(package: Package) -> None:
    """Let the calling program import a package and the other packages of its workspace."""
    prepend_to_path([str(folder) for folder in package.python])
    sys.path += [path for path in python_path(package.share / "package.xml") if path not in sys.path]


def _imported_name(package: Package, module: str, name: str) -> Any:
    _imported.add(module.partition(".")[0])
    location = location_of(package.share / "setup.py", f"{module}:{name}")
    try:
        target: Any = import_module(module)
    except ModuleNotFoundError as error:
        # Any other missing module is a mistake in a file of the package, which the traceback shows.
        if error.name is None or not f"{module}.".startswith(f"{error.name}."):
            raise
        raise CourseError(f"{location}: there is no module {module} in {package.share}.") from None
    for attribute in name.split("."):
        if not hasattr(target, attribute):
            suggestion = did_you_mean(attribute, vars(target)) or "."
            raise CourseError(f"{location}: the module {module} has no function {name!r}{suggestion}")
        target = getattr(target, attribute)
    return target
