"""Import hooks: modules under ROS's names, interface packages, and packages of the workspace.

A package of ROS often has a module for each class, like `launch_ros.actions.node`, where the
stand-in has one module for the subject. Programs import both forms. Modules that hardly any program
imports by their own names, like `rclpy.type_hash`, are in `HOME_MODULES` only. Importing such a
package also imports its submodules in ROS, and on access here: `SUBMODULES`.
"""

import os
import re
import sys
from collections.abc import Iterator, Sequence
from functools import cache, partial
from importlib import import_module
from importlib.abc import Loader
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from importlib.util import spec_from_file_location, spec_from_loader
from pathlib import Path
from types import FrameType, ModuleType
from typing import Any

from course_lib.errors import CourseError

# Packages of ROS with one module per class. In the stand-in, the class is in the module of its
# subject.
FOLDERS = (
    *("launch", "launch.actions", "launch.conditions", "launch.event_handlers", "launch.events"),
    *("launch.launch_description_sources", "launch.substitutions"),
    *("launch_ros.utilities", "launch_ros.actions", "launch_ros.descriptions", "launch_ros.event_handlers"),
    *("launch_ros.events.lifecycle", "launch_xml.launch_description_sources"),
    "launch_yaml.launch_description_sources",
    "launch_ros.substitutions",
)
# Attributes of a module once it is imported. Here, each is imported on first access.
SUBMODULES = {
    "launch": (
        *("actions", "conditions", "descriptions", "event_handlers", "events", "frontend", "logging"),
        *("launch_description_sources", "substitutions", "utilities"),
    ),
    "launch.events": ("matchers", "process"),
    "launch_ros": (
        *("actions", "descriptions", "event_handlers", "events", "parameter_descriptions"),
        *("substitutions", "utilities"),
    ),
    "launch_ros.events": ("lifecycle", "matchers"),
    "launch_xml": ("launch_description_sources",),
    "launch_yaml": ("launch_description_sources",),
    "rosbag2_py": ("_compression_options", "_info", "_reader", "_storage", "_writer"),
    "ros2_numpy": ("geometry", "image", "occupancy_grid", "point_cloud2", "registry"),
}
HOME_MODULES = {
    "ament_index_python.resources": "ament_index_python.packages",
    "diagnostic_updater._diagnostic_updater": "diagnostic_updater",
    "diagnostic_updater._update_functions": "diagnostic_updater",
    "launch.actions.shutdown_action": "launch.actions",
    "launch.descriptions": "launch.actions",
    "launch.events.matchers": "launch.events",
    "launch.events.process": "launch.events",
    "launch.launch_description": "launch.actions",
    "launch.launch_description_entity": "launch.entities",
    "launch.substitutions.boolean_substitution": "launch.substitutions",
    "launch_ros.events.matchers": "launch_ros.events.lifecycle",
    "launch_ros.parameters_type": "launch_ros.utilities",
    "launch_ros.remap_rule_type": "launch_ros.utilities",
    "launch_ros.substitutions.find_package": "launch_ros.substitutions",
    "launch_yaml.launch_description_sources": "launch_xml.launch_description_sources",
    "rclpy._rclpy_pybind11": "rclpy.impl.implementation_singleton",
    "rclpy.clock_type": "rclpy.time",
    "rclpy.constants": "rclpy.duration",
    "rclpy.expand_topic_name": "rclpy.impl.names",
    "rclpy.guard_condition": "rclpy.impl.node_handle",
    "rclpy.impl.logging_severity": "rclpy.impl.arguments",
    "rclpy.lifecycle.managed_entity": "rclpy.lifecycle.node",
    "rclpy.lifecycle.publisher": "rclpy.lifecycle.node",
    "rclpy.logging_service": "rclpy.parameter_service",
    "rclpy.qos_event": "rclpy.event_handler",
    "rclpy.topic_endpoint_info": "rclpy.impl.graph_queries",
    "rclpy.topic_or_service_is_hidden": "rclpy.impl.names",
    "rclpy.type_description_service": "rclpy.parameter_service",
    "rclpy.type_hash": "rclpy.impl.graph_queries",
    "rclpy.validate_full_topic_name": "rclpy.impl.names",
    "rclpy.validate_namespace": "rclpy.impl.names",
    "rclpy.validate_node_name": "rclpy.impl.names",
    "rclpy.validate_parameter_name": "rclpy.impl.names",
    "rclpy.validate_topic_name": "rclpy.impl.names",
    "ros2_numpy.geometry": "ros2_numpy",
    "ros2_numpy.image": "ros2_numpy",
    "ros2_numpy.occupancy_grid": "ros2_numpy",
    "ros2_numpy.point_cloud2": "ros2_numpy",
    "ros2_numpy.registry": "ros2_numpy",
    "rosbag2_py._compression_options": "rosbag2_py",
    "rosbag2_py._info": "rosbag2_py",
    "rosbag2_py._reader": "rosbag2_py",
    "rosbag2_py._storage": "rosbag2_py",
    "rosbag2_py._writer": "rosbag2_py",
    "rosidl_parser.definition": "course_lib.ros.messages.idl",
    "rosidl_runtime_py.convert": "rosidl_runtime_py",
    "rosidl_runtime_py.get_interfaces": "rosidl_runtime_py",
    "rosidl_runtime_py.import_message": "rosidl_runtime_py.utilities",
    "rosidl_runtime_py.set_message": "rosidl_runtime_py",
    "tf2_ros.static_transform_listener": "tf2_ros.transform_listener",
}


# Names that a module only re-exports although programs import them from it, by defining module.
THIRD_PARTY_IMPORTS: dict[str, dict[str, list[str]]] = {}
for _line in Path(__file__).with_name("third_party_imports.txt").read_text("utf-8").splitlines():
    if _line and not _line.startswith("#"):
        _host, _home, *_names = _line.split()
        THIRD_PARTY_IMPORTS.setdefault(_host, {})[_home] = _names
_PACKAGES = {name.partition(".")[0] for name in (*FOLDERS, *SUBMODULES, *HOME_MODULES, *THIRD_PARTY_IMPORTS)}
_PYTHON = os.path.dirname(os.__file__) + os.sep
_WORD = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


class HomeModuleFinder(Loader):
    """Imports a module of ROS that the stand-in lacks, with all names of its home module."""

    @classmethod
    def find_spec(
        cls, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find the home module in the table, or by the name of a class."""
        folder, _, last_name = name.rpartition(".")
        if name.partition(".")[0] not in _PACKAGES:
            return None
        home = HOME_MODULES.get(name)
        is_host = name in THIRD_PARTY_IMPORTS or name in SUBMODULES
        if home is None and (is_host or name in FOLDERS):
            spec = PathFinder.find_spec(name, path)
            if spec is None or spec.origin is None:
                return spec
            if is_host:
                spec.loader = _HostLoader(name, spec.origin)
            # Python searches for submodules in packages only, so the module becomes one.
            if name in FOLDERS and spec.submodule_search_locations is None:
                spec.submodule_search_locations = []
            return spec
        # For a module per class, like launch.actions.execute_process, the home is its folder.
        if home is None and folder in FOLDERS:
            names = {_WORD.sub("_", class_name).lower() for class_name in vars(import_module(folder))}
            home = folder if last_name in names else None
        if home is None:
            return None
        return spec_from_loader(name, cls(), origin=home, is_package=name in FOLDERS)

    def exec_module(self, module: ModuleType) -> None:
        """Copy the names of the home module."""
        home = import_module(str(module.__spec__ and module.__spec__.origin))
        vars(module).update({name: value for name, value in vars(home).items() if not name.startswith("__")})


class _HostLoader(SourceFileLoader):
    """Imports a module of the stand-in, with submodules and names that ROS's module imports."""

    def exec_module(self, module: ModuleType) -> None:
        """Execute the module's code."""
        vars(module)["__getattr__"] = partial(_imported_name, module.__name__)
        super().exec_module(module)


def _imported_name(host: str, name: str) -> Any:
    """Return an object that ROS's module imports, and that programs import from it."""
    # Every `from … import` also requests __path__.
    if not name.startswith("__"):
        if name in SUBMODULES.get(host, ()) or f"{host}.{name}" in HOME_MODULES:
            return import_module(f"{host}.{name}")
        for home, names in THIRD_PARTY_IMPORTS.get(host, {}).items():
            if name in names:
                return getattr(import_module(home), name)
    raise AttributeError(f"module '{host}' has no attribute '{name}'")


class WorkspaceImports:
    """Finds packages in the workspace's sources by ROS name, if Python does not find them."""

    @classmethod
    def find_spec(
        cls, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find a Python package, or a package with interface files."""
        # Python itself tries modules of other platforms, like msvcrt, which no workspace contains.
        if path is not None or "." in name or name in sys.stdlib_module_names:
            return None
        return None if _is_library(sys._getframe(1)) else _find_in_workspace(name)


class PackageFolderImports:
    """Finds a package in the workspace if Python would import the folder around it instead.

    In `src`, Python takes the folder `src/arm` of the ROS package `arm` for a namespace package and
    misses the Python package in `src/arm/arm`. As in Python, a regular package takes precedence.
    """

    @classmethod
    def find_spec(
        cls, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find the package if a folder of its name without `__init__.py` is on Python's path."""
        if path is not None or "." in name or name in sys.stdlib_module_names:
            return None
        if not any(os.path.isdir(os.path.join(entry, name)) for entry in _own_entries()):
            return None
        spec = PathFinder.find_spec(name)
        is_namespace = spec is not None and spec.origin is None and spec.submodule_search_locations
        return _find_in_workspace(name) if is_namespace else None


def _find_in_workspace(name: str) -> ModuleSpec | None:
    # Imported late because few programs need it, but this module is imported whenever the kit is.
    from course_lib.ros.programs.packages import has_interfaces, packages

    folders = packages(in_working_folder=_imports_from_working_folder())
    for package in (name, *folders) if name in folders else folders:
        if spec := _python_spec(name, package, folders[package]):
            return spec
    if name in folders and has_interfaces(folders[name]):
        spec = ModuleSpec(name, None, is_package=True)
        spec.submodule_search_locations = [str(folders[name])]
        return spec
    return None


def _is_library(frame: FrameType | None) -> bool:
    """Return whether a module of a library does the import; then the workspace is not searched.

    numpy alone tries a dozen optional modules, each of which would be searched for in all packages.
    """
    while frame is not None and "importlib" in frame.f_code.co_filename:
        frame = frame.f_back
    if frame is None or frame.f_code.co_name != "<module>":
        return False
    file = frame.f_code.co_filename
    return file.startswith(_PYTHON) or f"{os.sep}site-packages{os.sep}" in file


def _python_spec(name: str, package: str, sources: Path) -> ModuleSpec | None:
    from course_lib.ros.programs.build_files import read_build_files

    if sources.parent.name == "share":
        return None
    if name != package and (sources / name / "__init__.py").is_file():
        return PathFinder.find_spec(name, [str(sources)])
    try:
        folders = read_build_files(package, sources).package_folders
    except CourseError:
        # A syntax error in setup.py is reported where the package is used, not at each import.
        return None
    renamed = folders.get(name)
    if renamed is not None:
        return spec_from_file_location(
            name, renamed / "__init__.py", submodule_search_locations=[str(renamed)]
        )
    root = folders.get("", sources)
    if (root / name / "__init__.py").is_file():
        return PathFinder.find_spec(name, [str(root)])
    return None


def _imports_from_working_folder() -> bool:
    """Return whether Python imports from the working folder, or a folder in it, anyway.

    A process that grades submissions must not import them because it was started in their folder.
    """
    try:
        working_folder = os.getcwd()
    except OSError:
        # The working folder was deleted.
        return False
    return any(
        not entry or entry == working_folder or entry.startswith(f"{working_folder}{os.sep}")
        for entry in _own_entries()
    )


def _own_entries() -> list[str]:
    """Return the entries of sys.path that contain neither libraries nor the stand-in."""
    return [
        entry
        for entry in sys.path
        if "site-packages" not in entry and entry != _STANDIN_ENTRY and not entry.startswith(_PYTHON[:-1])
    ]


STANDIN = Path(__file__).parents[1] / "standin"
_STANDIN_ENTRY = str(STANDIN)
# Environment variables that setup.bash sets in ROS.
SOURCED = {"ROS_DISTRO": "jazzy", "ROS_VERSION": "2", "ROS_PYTHON_VERSION": "3"}
KINDS = ("msg", "srv", "action")


def install() -> None:
    """Put the stand-in's packages first on sys.path, and set ROS's environment variables.

    Raises a CourseError if a package of the same name has already been imported from elsewhere.
    """
    # xacro uses this module without importing it: a program that processes a missing file would
    # have an AttributeError.
    import xml.parsers.expat  # noqa: F401  # it becomes an attribute of xml

    standin_folder = str(STANDIN)
    for name in provided_packages():
        module = sys.modules.get(name)
        if module is not None and not _location_of(module).startswith(f"{standin_folder}{os.sep}"):
            raise CourseError(
                f"{name} has already been imported from {_location_of(module)}, so the course's "
                "own ROS can't take its place. Restart the kernel and load course_lib first: "
                "%load_ext course_lib"
            )
    for name, value in SOURCED.items():
        os.environ.setdefault(name, value)
    if sys.path[:1] != [standin_folder]:
        sys.path[:] = [standin_folder, *(entry for entry in sys.path if entry != standin_folder)]
    if _InterfaceTypesFinder not in sys.meta_path:
        sys.meta_path[:0] = [_InterfaceTypesFinder, HomeModuleFinder, PackageFolderImports]
        sys.meta_path.append(WorkspaceImports)


class _InterfaceTypesFinder(Loader):
    """Imports interface types: `std_msgs`, `std_msgs.msg` or `my_msgs/msg/Name.msg`."""

    @classmethod
    def find_spec(
        cls, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find a package whose types the kit has, or a folder with interface files."""
        package, _, kind = name.rpartition(".")
        if not package:
            # A package for which the build has written only stubs.
            stub_folder = STANDIN / name
            if not stub_folder.is_dir() or (stub_folder / "__init__.py").is_file():
                return None
            spec = ModuleSpec(name, cls(), origin=str(stub_folder), is_package=True)
            spec.submodule_search_locations = [str(stub_folder)]
            return spec
        if kind not in KINDS or "." in package:
            return None
        # Imported here, because each import of a program calls this method.
        from course_lib.ros.programs.packages import interface_paths

        for folder in _interface_folders(package, path or ()):
            if (
                _has_types(package, kind)
                if folder.parent == STANDIN
                else any(True for _ in interface_paths(folder, kind))
            ):
                return spec_from_loader(name, cls(), origin=str(folder))
        return None

    def exec_module(self, module: ModuleType) -> None:
        """Fill the module with the types. The package itself remains empty."""
        from course_lib.ros.messages.definitions import add_package
        from course_lib.ros.messages.message import fill_module

        if "." not in module.__name__:
            vars(module)["__getattr__"] = partial(_loaded_types_module, module.__name__)
            return
        folder = Path(str(module.__spec__ and module.__spec__.origin))
        if folder.parent != STANDIN:
            add_package(folder, module.__name__.partition(".")[0])
        fill_module(module)


def _interface_folders(package: str, path: Sequence[str]) -> Iterator[Path]:
    """Yield the folders that may contain a package's interface files: `path`, and their parents."""
    # Imported late because only programs with their own interface files need it.
    from course_lib.ros.programs.packages import MANIFEST, name_of

    for folder in map(Path, path):
        yield folder
        # The folder of Python code is in the package's folder, or in a subfolder such as `src`.
        if folder.name == package:
            yield from (above for above in folder.parents[:2] if name_of(above / MANIFEST) == package)


def _loaded_types_module(package: str, name: str) -> ModuleType:
    """Return `std_msgs.msg` if a message of std_msgs is loaded, since ROS has imported it then."""
    from course_lib.ros.messages.message import loaded

    if name not in KINDS or package not in loaded or not _has_types(package, name):
        raise AttributeError(f"module '{package}' has no attribute '{name}'")
    return import_module(f"{package}.{name}")


def _has_types(package: str, kind: str) -> bool:
    from course_lib.ros.messages.definitions import type_names

    return any(name.startswith(f"{package}/{kind}/") for name in type_names())


@cache
def provided_packages() -> list[str]:
    """List the packages that the stand-in provides."""
    code = {path.parent for path in STANDIN.glob("*/__init__.py")}
    types = {path.parents[1] for path in STANDIN.glob("*/*/__init__.pyi")}
    return sorted(folder.name for folder in code | types)


def _location_of(module: ModuleType) -> str:
    """Return the location of a module: its file, or the folder of a package without one."""
    file = getattr(module, "__file__", None)
    return str(file or next(iter(getattr(module, "__path__", [])), "an unknown place"))
