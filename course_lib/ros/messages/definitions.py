"""The fields of all ROS message types: rosbags' type store, with the types and defaults that it lacks.

The types are files in the folder ``interfaces``, laid out as in ROS packages.
"""

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.messages.interface_files import LazyTypes, check_interface, read_defaults, read_interface

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

# common_interfaces and rcl_interfaces (jazzy): every field whose .msg line gives a default value.
DEFAULTS: dict[tuple[str, str], Any] = {
    ("geometry_msgs/msg/Quaternion", "x"): 0.0,
    ("geometry_msgs/msg/Quaternion", "y"): 0.0,
    ("geometry_msgs/msg/Quaternion", "z"): 0.0,
    ("geometry_msgs/msg/Quaternion", "w"): 1.0,
    ("rcl_interfaces/msg/ParameterDescriptor", "dynamic_typing"): False,
    ("rcl_interfaces/msg/ParameterDescriptor", "read_only"): False,
    ("sensor_msgs/msg/NavSatStatus", "status"): -2,
    ("type_description_interfaces/msg/FieldType", "type_id"): 0,
}
EVENT_PART = "_Event"  # of a service, on the topic of its introspection
NO_WIDE_STRINGS = "the kit has no wide strings (wstring). Write string: it holds all characters, too."
FOLDERS = [Path(__file__).parent.parent / "interfaces"]  # of packages' folders; the kit's own is the first


@dataclass(frozen=True, slots=True)
class FieldDefinition:
    """One line of a .msg file; ``base`` is a primitive (``float64``) or a message type's full name."""

    name: str
    base: str
    string_bound: int  # longest string, 0: any
    container: Literal["scalar", "array", "sequence"]
    size: int  # an array's length, a sequence's greatest length, 0: any
    default: Any  # None where the .msg file gives none

    @property
    def is_message(self) -> bool:
        """True if the field holds other messages."""
        return "/" in self.base


@dataclass(frozen=True, slots=True)
class MessageDefinition:
    """One .msg file."""

    type_name: str
    constants: Mapping[str, Any]
    fields: tuple[FieldDefinition, ...]


@cache
def typestore() -> "Typestore":
    """Return rosbags' store of ROS 2 Jazzy types with those in the folder."""
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    store.fielddefs = cast(
        "dict[str, Any]", LazyTypes(cast("dict[str, Any]", store.fielddefs), FOLDERS[0], DEFAULTS)
    )
    return store


def add_package(package: Path) -> None:
    """Add a package's own interface files, like ``my_msgs/msg/Name.msg``, to the store.

    Raises a CourseError if one is not well formed, or names a type that is not there.
    """
    from rosbags.typesys import TypesysError

    if package.parent not in FOLDERS:
        FOLDERS.append(package.parent)
    paths = sorted(path for path in package.glob("*/*.*") if path.suffix == f".{path.parent.name}")
    for path in paths:
        check_interface(path)
        try:
            typestore().register(read_interface(path))
        except TypesysError as error:
            raise CourseError(f"{path} has changed since it was read: restart the kernel.") from error
        DEFAULTS.update(read_defaults(path))
    known = typestore().fielddefs
    for file, name in ((path, name) for path in paths for name in read_interface(path)):
        for field in (field for field in definition(name).fields if field.is_message):
            other = field.base.split("/")[0]
            if field.base not in known and other != package.name:
                find_package(other)
            if field.base == f"{package.name}/msg/wstring":
                raise CourseError(f"{file}, field {field.name}: {NO_WIDE_STRINGS}")
            if field.base not in known:
                raise CourseError(f"{file}, field {field.name}: No message type {field.base!r} here.")


def find_package(package: str) -> None:
    """Add a package that is not known yet, if its folder is on Python's path or here."""
    for entry in (*sys.path, "."):
        folder = Path(entry, package)
        if package.isidentifier() and next(folder.glob("[msa]*/*.[msa]*"), None) is not None:
            add_package(folder)
            return


def type_names() -> list[str]:
    """List the known types, like ``visualization_msgs/msg/Marker``, without the events of services."""
    return sorted(name for name in typestore().fielddefs if not name.endswith(EVENT_PART))


@cache
def definition(type_name: str) -> MessageDefinition:
    """Look a type up; a CourseError names the closest ones if there is none."""
    known = typestore().fielddefs
    if type_name not in known:
        find_package(type_name.split("/")[0])
    service = type_name.removesuffix(EVENT_PART)
    if service != type_name and f"{service}_Request" in known:
        known[type_name] = event_of(service)
    if type_name not in known:
        meant = did_you_mean(type_name, known, 3) or ". Written like visualization_msgs/msg/Marker."
        raise CourseError(f"No message type {type_name!r} here{meant}")
    constants, fields = known[type_name]
    return MessageDefinition(
        type_name,
        {name: bytes([int(value)]) if base == "byte" else value for name, base, value in constants},
        tuple(_field(type_name, name, desc) for name, desc in fields),
    )


def event_of(service: str) -> Any:
    """Return the definition of a service's event, which rosidl makes of its request and its response."""
    from rosbags.interfaces import Nodetype

    parts = (("request", f"{service}_Request"), ("response", f"{service}_Response"))
    fields = [(name, (Nodetype.SEQUENCE, ((Nodetype.NAME, part), 1))) for name, part in parts]
    return [], [("info", (Nodetype.NAME, "service_msgs/msg/ServiceEventInfo")), *fields]


def _field(type_name: str, name: str, desc: Any) -> FieldDefinition:
    """Read rosbags' nested tuples ``(kind, (inner, size))``; a base type is ``(1, (name, string_bound))``."""
    default = DEFAULTS.get((type_name, name))
    kind, detail = desc
    container, size = _CONTAINERS[kind], 0
    if container != "scalar":
        (kind, detail), size = detail
    base, bound = (detail, 0) if isinstance(detail, str) else detail
    return FieldDefinition(name, base, bound, container, size, default)


# rosbags.interfaces.Nodetype by value.
_CONTAINERS: Mapping[int, Literal["scalar", "array", "sequence"]] = {
    1: "scalar",
    2: "scalar",
    3: "array",
    4: "sequence",
}


@dataclass(frozen=True, slots=True)
class Primitive:
    """One primitive: its name in ROS's IDL, its Python type, for numbers the range and the array code."""

    ros_name: str
    python: type
    code: str = ""  # of array.array and numpy; "" if ROS keeps sequences of it as lists
    low: float = 0  # the range that ROS checks; numbers only
    high: float = 0
    range_word: str = ""  # "integer" in "an integer in [-128, 127]"; "" if any value fits

    @property
    def dtype(self) -> "np.dtype[np.generic]":
        """The numpy type of one element."""
        return np.dtype(self.code or bool)


def _integer(ros_name: str, code: str) -> Primitive:
    limits = np.iinfo(np.dtype(code))
    word = "integer" if limits.min else "unsigned integer"
    return Primitive(ros_name, int, code, int(limits.min), int(limits.max), word)


PRIMITIVES: Mapping[str, Primitive] = {
    "bool": Primitive("boolean", bool),
    "byte": Primitive("octet", bytes),
    "char": _integer("uint8", "B"),
    "int8": _integer("int8", "b"),
    "uint8": _integer("uint8", "B"),
    "int16": _integer("int16", "h"),
    "uint16": _integer("uint16", "H"),
    "int32": _integer("int32", "i"),
    "uint32": _integer("uint32", "I"),
    "int64": _integer("int64", "q"),
    "uint64": _integer("uint64", "Q"),
    "float32": Primitive("float", float, "f", -3.402823466e38, 3.402823466e38, "float"),
    "float64": Primitive("double", float, "d", -1.7976931348623157e308, 1.7976931348623157e308, "double"),
    "string": Primitive("string", str),
}
