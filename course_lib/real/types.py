"""The types without a wheel, as data for the process under the real rclpy.

That process runs `python -m course_lib.real.types PACKAGE PROGRAM…` when a program imports such a
package.
"""

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.messages import message_class
from course_lib.ros.messages.definitions import (
    PRIMITIVES,
    UNSUPPORTED,
    add_package,
    definition,
    field_definitions,
    type_hash,
    type_names,
)
from course_lib.ros.messages.message import module_of_type
from course_lib.ros.programs.packages import has_interfaces, packages

# Suffixes of the first part's name.
_SERVICE, _ACTION = "_Request", "_Goal"


def missing_packages(
    installed: Iterable[str],
    programs: Iterable[Path],
) -> tuple[list[str], list[str]]:
    """Return the packages of types without a wheel, and a line for each unreadable package.

    Args:
        installed: The packages of the environment.
        programs: Files whose folders may contain packages with interface files.
    """
    problems = _add_own_packages(programs)
    names = {name.partition("/")[0] for name in type_names()}
    return sorted(names - set(installed)), problems


def types_of(package: str) -> dict[str, dict[str, Any]]:
    """Return all types of a package by name: module, fields, constants, defaults and hash of messages.

    For services and actions, which consist of messages, only kind, module and hash are returned.
    """
    descriptions: dict[str, dict[str, Any]] = {}
    names = [name for name in type_names() if name.startswith(f"{package}/") and name not in UNSUPPORTED]
    for name in names:
        defaults: dict[str, Any] = {}
        for field in definition(name).fields:
            is_float = field.base in PRIMITIVES and PRIMITIVES[field.base].python is float
            if field.default is not None and is_float and field.container == "scalar":
                defaults[field.name] = float(field.default)
            elif field.default is not None and is_float:
                defaults[field.name] = [float(x) for x in field.default]
            elif field.default is not None:
                defaults[field.name] = field.default
        descriptions[name] = {
            "module": module_of_type(name),
            "fields": message_class(name).get_fields_and_field_types(),
            "constants": dict(definition(name).constants),
            "defaults": defaults,
            "hash": type_hash(name.removesuffix("_Request").removesuffix("_Response")),
        }
        for end, kind in ((_SERVICE, "service"), (_ACTION, "action")):
            if name.endswith(end):
                base_name = name.removesuffix(end)
                # Only the hashes of an action's services are used in communication, not a hash of
                # the action.
                descriptions[base_name] = {
                    "kind": kind,
                    "module": module_of_type(base_name),
                    "hash": type_hash(base_name if kind == "service" else name),
                }
    return descriptions


def _add_own_packages(programs: Iterable[Path]) -> list[str]:
    """Add the packages of the workspace and of the programs' folders. Return the problems."""
    ros_packages = {name.partition("/")[0] for name in field_definitions()}
    folders = {name: folder for name, folder in packages().items() if has_interfaces(folder)}
    for parent in {program.resolve().parent for program in programs}:
        folders |= {path.name: path for path in parent.iterdir() if path.is_dir() and has_interfaces(path)}
    problems = []
    for name, folder in folders.items():
        try:
            if name not in ros_packages:
                add_package(folder, name)
        except CourseError as error:
            problems.append(f"{name} cannot be imported: {error}")
    return problems


def main() -> None:
    """Print the types of a package. Further arguments are programs whose folders are searched."""
    package, *programs = sys.argv[1:]
    _add_own_packages(map(Path, programs))
    sys.stdout.write(repr(types_of(package)))


if __name__ == "__main__":
    main()
