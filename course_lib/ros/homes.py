"""Modules of ROS packages whose names the stand-in keeps elsewhere, like `launch_ros.actions.node`."""

import re
from collections.abc import Sequence
from functools import partial
from importlib import import_module
from importlib.abc import Loader
from importlib.machinery import ModuleSpec, PathFinder, SourceFileLoader
from importlib.util import spec_from_file_location, spec_from_loader
from pathlib import Path
from types import ModuleType
from typing import Any

# A package of ROS has a module for each class; here a class is in the module of its subject.
FOLDERS = (
    *("launch", "launch.actions", "launch.conditions", "launch.event_handlers", "launch.events"),
    *("launch.launch_description_sources", "launch.substitutions"),
    *("launch_ros.actions", "launch_ros.descriptions", "launch_ros.event_handlers"),
    *("launch_ros.events.lifecycle", "launch_xml.launch_description_sources"),
    "launch_yaml.launch_description_sources",
    "launch_ros.substitutions",
)
HOMES = {
    "launch.actions.shutdown_action": "launch.actions",
    "launch.descriptions": "launch.processes",
    "launch.launch_description": "launch.actions",
    "launch.events.matchers": "launch.events",
    "launch.events.process": "launch.events",
    "launch.launch_description_entity": "launch.entities",
    "launch.substitutions.boolean_substitution": "launch.substitutions",
    "launch_ros.substitutions.find_package": "launch_ros.substitutions",
    "rclpy._rclpy_pybind11": "rclpy.exceptions",
    "rclpy.expand_topic_name": "rclpy.impl.names",
    "rclpy.guard_condition": "rclpy.impl.node_handle",
    "rclpy.qos_event": "rclpy.event_handler",
    "rclpy.topic_endpoint_info": "rclpy.impl.graph_queries",
    "rclpy.validate_full_topic_name": "rclpy.impl.names",
    "rclpy.validate_namespace": "rclpy.impl.names",
    "rclpy.validate_node_name": "rclpy.impl.names",
    "rclpy.validate_topic_name": "rclpy.impl.names",
}


def _guests() -> dict[str, dict[str, list[str]]]:
    """Read the names that programs import from modules which only import them: by module, then by home."""
    found: dict[str, dict[str, list[str]]] = {}
    for line in Path(__file__).with_name("guests.txt").read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            host, home, *names = line.split()
            found.setdefault(host, {})[home] = names
    return found


GUESTS = _guests()
_PACKAGES = {name.partition(".")[0] for name in (*FOLDERS, *HOMES, *GUESTS)}
_WORD = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


class Homes(Loader):
    """Imports such a module, with all names of the module that is its home."""

    @classmethod
    def find_spec(
        cls, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Find the home in the table, or the class that the module is named for."""
        folder, _, own = name.rpartition(".")
        if name.partition(".")[0] not in _PACKAGES:
            return None
        if folder and name in FOLDERS:
            return _as_package(name, path)
        if name in GUESTS:
            return _with_guests(name, path)
        home = HOMES.get(name)
        if (
            home is None
            and folder in FOLDERS
            and own in {_snake(word) for word in vars(import_module(folder))}
        ):
            home = folder
        return None if home is None else spec_from_loader(name, cls(), origin=home)

    def exec_module(self, module: ModuleType) -> None:
        """Copy the names of the home."""
        home = import_module(str(module.__spec__ and module.__spec__.origin))
        vars(module).update({name: value for name, value in vars(home).items() if not name.startswith("__")})


class _Host(SourceFileLoader):
    """Imports a module of the stand-in; the names that ROS's imports from others are found when asked for."""

    def exec_module(self, module: ModuleType) -> None:
        """Run the module's code."""
        vars(module)["__getattr__"] = partial(_guest, module.__name__)
        super().exec_module(module)


def _guest(host: str, name: str) -> Any:
    """Return a name that programs import from a module, because ROS's module imports it."""
    if name.startswith("__"):  # each import of a name asks for __path__
        raise AttributeError(f"module '{host}' has no attribute '{name}'")
    for home, names in GUESTS[host].items():
        if name in names:
            return getattr(import_module(home), name)
    raise AttributeError(f"module '{host}' has no attribute '{name}'")


def _with_guests(name: str, path: Sequence[str] | None) -> ModuleSpec | None:
    spec = PathFinder.find_spec(name, path)
    if spec is None or spec.origin is None:
        return spec
    return spec_from_file_location(name, spec.origin, loader=_Host(name, spec.origin))


def _as_package(name: str, path: Sequence[str] | None) -> ModuleSpec | None:
    """Find a module as ever, and make it a package, so that Python looks for modules in it."""
    spec = PathFinder.find_spec(name, path)
    if spec is not None and spec.submodule_search_locations is None:
        spec.submodule_search_locations = []
    return spec


def _snake(name: str) -> str:
    return _WORD.sub("_", name).lower()
