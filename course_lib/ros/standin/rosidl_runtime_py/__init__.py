"""Conversions of messages to YAML, CSV and dictionaries and back, and the interfaces of packages."""

from collections import OrderedDict
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

from ament_index_python.packages import get_package_prefix

from course_lib.ros.messages import definitions
from course_lib.ros.messages.conversions import PrintOptions, set_fields, to_csv, to_dict, to_yaml
from course_lib.ros.programs import packages
from course_lib.ros.programs.import_path import provided_packages
from course_lib.ros.programs.packages import INSTALLED
from rosidl_runtime_py.utilities import (
    import_message_from_namespaced_type as import_message_from_namespaced_type,
)

_KINDS = ("msg", "srv", "action")


def message_to_yaml(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
    flow_style: bool = False,
) -> str:
    """Convert a message to YAML, in block or flow style. Long values can be truncated."""
    return to_yaml(msg, PrintOptions(truncate_length, no_arr, no_str, flow_style))


def message_to_csv(
    msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> str:
    """Convert a message's values to comma-separated text."""
    return to_csv(msg, PrintOptions(truncate_length, no_arr, no_str))


def message_to_ordereddict(
    msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> "OrderedDict[str, Any]":
    """Convert a message to nested dictionaries in the order of its fields."""
    ordered: OrderedDict[str, Any] = _to_ordered(to_dict(msg, PrintOptions(truncate_length, no_arr, no_str)))
    return ordered


def get_message_slot_types(msg: Any) -> "OrderedDict[str, Any]":
    """Return the types of a message's fields by name, as objects of rosidl_parser."""
    return OrderedDict(zip(msg.get_fields_and_field_types(), msg.SLOT_TYPES, strict=True))


def _to_ordered(value: Any) -> Any:
    if isinstance(value, dict):
        return OrderedDict((name, _to_ordered(item)) for name, item in value.items())
    return [_to_ordered(item) for item in value] if isinstance(value, list) else value


def set_message_fields(
    msg: Any,
    values: dict[str, Any],
    expand_header_auto: bool = False,
    expand_time_now: bool = False,
) -> list[Callable[[Any], None]]:
    """Set fields by name.

    Raises AttributeError for an unknown field and TypeError for a wrong value.

    Returns:
        Functions that set the headers given as "auto" and the times given as "now".
    """
    return set_fields(msg, values, expand_header_auto=expand_header_auto, expand_time_now=expand_time_now)


def get_interface_packages() -> dict[str, str]:
    """Return the installation prefixes of all packages with interfaces, by name."""
    own_packages = packages.packages()
    return {
        name: get_package_prefix(name) if name in own_packages else str(INSTALLED.parent)
        for name in _interface_names((), _KINDS)
    }


def get_interfaces(package_names: Collection[str] = ()) -> dict[str, list[str]]:
    """Return the interfaces of packages, by default all, as lists like `msg/String` by package.

    A package without interfaces is left out.

    Raises:
        LookupError: A package is unknown.
    """
    return _interface_names(package_names, _KINDS)


def get_message_interfaces(package_names: Collection[str] = ()) -> dict[str, list[str]]:
    """Return the messages of packages as `get_interfaces` does."""
    return _interface_names(package_names, ("msg",))


def get_service_interfaces(package_names: Collection[str] = ()) -> dict[str, list[str]]:
    """Return the services of packages as `get_interfaces` does."""
    return _interface_names(package_names, ("srv",))


def get_action_interfaces(package_names: Collection[str] = ()) -> dict[str, list[str]]:
    """Return the actions of packages as `get_interfaces` does."""
    return _interface_names(package_names, ("action",))


def get_interface_path(interface_name: str) -> str:
    """Return the path of an interface file, by a name such as `my_msgs/msg/Name` or `my_msgs/msg/Name.msg`.

    Raises:
        ValueError: The name is malformed.
        LookupError: The package is unknown, or has no such file.
    """
    parts = interface_name.split("/")
    if len(parts) < 2:
        raise ValueError(f"Invalid name '{interface_name}'. Expected at least two parts separated by '/'")
    if not all(parts):
        raise ValueError(f"Invalid name '{interface_name}'. Must not contain empty parts")
    if ".." in parts:
        raise ValueError(f"Invalid name '{interface_name}'. Must not contain '..'")
    _check_package(parts[0])
    package = packages.find_package(parts[0])
    share = INSTALLED / parts[0] if package is None else package.share
    path = share.joinpath(*parts[1:])
    if "." not in parts[-1]:
        with_suffix = Path(f"{path}.{parts[-2]}")
        if with_suffix.exists():
            return str(with_suffix)
        path = Path(f"{path}.idl")
    if not path.exists():
        advice = ""
        if package is None:
            advice = f": ROS's own files are not here, and `ros2 interface show {interface_name}` prints one"
        raise LookupError(f"Could not find the interface '{path}'{advice}")
    return str(path)


def _interface_names(
    package_names: Collection[str],
    kinds: Collection[str],
) -> dict[str, list[str]]:
    if package_names:
        for package in package_names:
            definitions.find_package(package)
    else:
        # An invalid file of the workspace is reported when its package is imported.
        definitions.find_workspace_packages()
    names: dict[str, list[str]] = {}
    for kind in kinds:
        for name in definitions.interfaces(kind):
            package, _, interface = name.partition("/")
            names.setdefault(package, []).append(interface)
    if not package_names:
        return names
    for package in package_names:
        if package not in names:
            _check_package(package)
    return {package: names[package] for package in package_names if package in names}


def _check_package(name: str) -> None:
    if name not in provided_packages() and packages.find_package(name) is None:
        raise LookupError(f"Unknown package '{name}'")
