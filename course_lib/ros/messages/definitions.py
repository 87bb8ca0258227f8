"""The fields of all message types, and the hashes of the types (REP 2016).

The fields come from rosbags' type store and from the kit's interface files.
"""

import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from keyword import iskeyword
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

import numpy as np

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.messages import interface_files
from course_lib.ros.programs.packages import has_interfaces, interface_paths, listed_interfaces, packages

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

# All fields of common_interfaces and rcl_interfaces (jazzy) whose .msg line has a default value.
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
# Suffix of a service's event type, used on its introspection topic.
EVENT_PART = "_Event"
NO_WIDE_STRINGS = "the kit has no wide strings (wstring). Write string: it holds all characters, too."
# Why the kit cannot represent a type, by type. Only using such a type is an error.
UNSUPPORTED: dict[str, str] = {}
# Parent folders of packages with interface files that a program has imported.
FOLDERS: list[Path] = []
# Folders of packages whose names differ from their folders' names.
RENAMED: dict[str, Path] = {}


@dataclass(frozen=True, slots=True)
class FieldDefinition:
    """A field of a .msg file.

    ``base`` is a primitive (``float64``) or the full name of a message type.
    """

    name: str
    base: str
    # Limit on the length of strings; 0: no limit.
    string_bound: int
    container: Literal["scalar", "array", "sequence"]
    # The length of an array, or the limit of a sequence; 0: no limit.
    size: int
    # None if the .msg file has no default.
    default: Any

    @property
    def is_message(self) -> bool:
        """True if the field contains messages."""
        return "/" in self.base


@dataclass(frozen=True, slots=True)
class MessageDefinition:
    """The content of a .msg file."""

    type_name: str
    constants: Mapping[str, Any]
    fields: tuple[FieldDefinition, ...]


@cache
def field_definitions() -> interface_files.LazyTypes:
    """Return the constants and fields of all types by name, in rosbags' format.

    They are the types of ROS 2 Jazzy in rosbags, and those in the kit's interface files; see
    `interface_files`.
    """
    table = interface_files.read_table()
    if table is not None:
        return interface_files.LazyTypes({}, interface_files.kit_files(), DEFAULTS, table)
    from rosbags.typesys import Stores, get_typestore

    return interface_files.LazyTypes(
        dict(get_typestore(Stores.ROS2_JAZZY).fielddefs), interface_files.kit_files(), DEFAULTS
    )


@cache
def typestore() -> "Typestore":
    """Return rosbags' own store with all types, for tasks left to rosbags, such as writing bags."""
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_JAZZY)
    store.fielddefs = cast("dict[str, Any]", field_definitions())
    return store


def add_package(folder: Path, name: str = "") -> None:
    """Add a package's own interface files, like ``my_msgs/msg/Name.msg``, to the store.

    Types with a wide string, or with such a type, are listed in `UNSUPPORTED`.

    Raises:
        CourseError: A file is invalid, or uses a type that does not exist.
    """
    from rosbags.typesys import TypesysError

    package = name or folder.name
    if package != folder.name:
        RENAMED[package] = folder
    elif folder.parent not in FOLDERS:
        FOLDERS.append(folder.parent)
    paths = _check_files(folder)
    for path in paths:
        try:
            typestore().register(interface_files.read_interface(path, package))
        except TypesysError as error:
            raise CourseError(f"{path} has changed since it was read: restart the kernel.") from error
        DEFAULTS.update(interface_files.read_defaults(path, package))
    definitions = field_definitions()
    types_by_file = {path: list(interface_files.read_interface(path, package)) for path in paths}
    used: dict[Path, set[str]] = {path: set() for path in paths}
    for file, name in ((path, name) for path, names in types_by_file.items() for name in names):
        for field in (field for field in _parse_definition(name).fields if field.is_message):
            other = field.base.split("/")[0]
            if field.base not in definitions and other != package:
                find_package(other)
            place = f"{file}, line {interface_files.line_of_field(file, field.name)}, field {field.name}"
            if field.base == f"{package}/msg/wstring":
                UNSUPPORTED.update(dict.fromkeys(types_by_file[file], f"{place}: {NO_WIDE_STRINGS}"))
            elif field.base not in definitions:
                unknown = f"No message type {field.base!r} here{_describe_unknown(field.base)}"
                raise CourseError(f"{place}: {unknown}")
            used[file].add(field.base)
    _reject_recursion(types_by_file)
    # Types that contain an unsupported type, at any depth.
    count = -1
    while count != len(UNSUPPORTED):
        count = len(UNSUPPORTED)
        for file, bases in used.items():
            if reason := next((UNSUPPORTED[base] for base in sorted(bases & UNSUPPORTED.keys())), ""):
                for name in types_by_file[file]:
                    UNSUPPORTED.setdefault(name, reason)


def _reject_recursion(types_by_file: Mapping[Path, Sequence[str]]) -> None:
    """Raise a CourseError if a type has a field of its own type, at any depth."""
    for file, name in ((file, name) for file, names in types_by_file.items() for name in names):
        inside, waiting = set[str](), [name]
        while waiting:
            fields = _parse_definition(waiting.pop()).fields
            bases = {field.base for field in fields if field.is_message}
            # The store has no type for wide strings.
            waiting += (bases - inside) & field_definitions().keys()
            inside |= bases
        if name in inside:
            raise CourseError(
                f"{file}: {name} contains itself, so no message of it would end. "
                "Remove the field, or send the inner messages on a topic of their own."
            )


def _check_files(folder: Path) -> list[Path]:
    """Return the interface files of a package.

    Raises a CourseError for an invalid file, except for one that CMakeLists.txt does not list: a build
    ignores it.
    """
    names, paths = listed_interfaces(folder), []
    for path in sorted(path for kind in FIRST_PARTS for path in interface_paths(folder, kind)):
        try:
            interface_files.check_interface(path)
            paths.append(path)
        except CourseError:
            if names is None or path.relative_to(folder).as_posix() in names:
                raise
    return paths


# Limits on the definition of a type in a bag: its characters, and the values of a message in which
# all sequences are empty.
_MOST_STORED_CHARACTERS, _MOST_STORED_VALUES = 100_000, 1_000_000


def add_stored_definition(type_name: str, text: str) -> None:
    """Add a type that no package here defines, with its text in a bag, in the format of .msg or .idl.

    Known types stay as they are. The type stays unknown if the text is invalid, exceeds a limit, or
    defines a known type differently.
    """
    from rosbags.typesys import TypesysError

    if not text or len(text) > _MOST_STORED_CHARACTERS or _is_defined(type_name):
        return
    stored, defaults = dict[str, Any](), dict[tuple[str, str], Any]()
    try:
        for file, content in interface_files.split_definitions(type_name, text).items():
            interface_files.check_lines(content, file)
            stored |= interface_files.parse_interface(content, file)
            defaults |= interface_files.parse_defaults(content, file)
    except (CourseError, TypesysError, ValueError, RecursionError):
        return
    # Field names become part of compiled Python code.
    names = (name for _, fields in stored.values() for name, _ in fields)
    if not all(name.isascii() and name.isidentifier() and not iskeyword(name) for name in names):
        return
    definitions = field_definitions()
    new_types = {name: fields for name, fields in stored.items() if not _is_defined(name)}
    if any(stored[name][1] != definitions[name][1] for name in stored.keys() - new_types.keys()):
        return
    counts = dict[str, float]()
    # The event of a service contains its request and response, and is defined by the service.
    service = type_name.removesuffix(EVENT_PART)
    roots = (
        [type_name] if type_name in new_types else [service + part for part in interface_files.SERVICE_PARTS]
    )
    if max(_count_values(root, new_types, counts) for root in roots) > _MOST_STORED_VALUES:
        return
    # Without rosbags' `register`, which executes code that it generates from the text.
    definitions.update({name: new_types[name] for name in counts})
    DEFAULTS.update({key: default for key, default in defaults.items() if key[0] in counts})


def _is_defined(type_name: str) -> bool:
    """Return whether a type is defined here, even if the kit cannot represent it."""
    try:
        definition(type_name)
    except CourseError:
        return type_name in field_definitions()
    return True


def _count_values(type_name: str, new_types: Mapping[str, Any], counts: dict[str, float]) -> float:
    """Count the values of a message with empty sequences; infinite for unknown or recursive types."""
    if type_name not in new_types:
        return 1 if _is_defined(type_name) and type_name not in UNSUPPORTED else math.inf
    if type_name not in counts:
        # The count while the fields are visited, which a recursive type finds.
        counts[type_name] = math.inf
        total = 1.0
        for name, form in new_types[type_name][1]:
            field = _field(type_name, name, form)
            count = _count_values(field.base, new_types, counts) if field.is_message else 1
            empty = field.container == "sequence" and count < math.inf
            total += 0 if empty else count * max(field.size, 1)
        counts[type_name] = total
    return counts[type_name]


def find_package(package: str) -> None:
    """Add an unknown package from Python's path, the working folder or the workspace."""
    if not package.isidentifier():
        return
    for entry in (*sys.path, "."):
        folder = Path(entry, package)
        if has_interfaces(folder):
            add_package(folder)
            return
    sources = packages().get(package)
    if sources is not None and has_interfaces(sources):
        add_package(sources, package)


def find_workspace_packages() -> list[str]:
    """Add all of the workspace's packages with interface files; return the errors of invalid files."""
    errors = list[str]()
    for name, folder in packages().items():
        if has_interfaces(folder):
            try:
                add_package(folder, name)
            except CourseError as error:
                errors.append(str(error))
    return errors


def type_names() -> list[str]:
    """List the known types, like ``std_msgs/msg/String``, without the event types of services."""
    return sorted(name for name in field_definitions() if not name.endswith(EVENT_PART))


@cache
def definition(type_name: str) -> MessageDefinition:
    """Return the definition of a type.

    Raise a CourseError with the closest names if there is none, or if the kit cannot represent it.
    """
    definitions = field_definitions()
    if type_name not in definitions:
        find_package(type_name.split("/")[0])
    service = type_name.removesuffix(EVENT_PART)
    if service != type_name and f"{service}_Request" in definitions:
        definitions[type_name] = event_definition(service)
    if type_name not in definitions:
        raise CourseError(f"No message type {type_name!r} here{_describe_unknown(type_name)}")
    if type_name in UNSUPPORTED:
        raise CourseError(UNSUPPORTED[type_name])
    return _parse_definition(type_name)


def _describe_unknown(type_name: str) -> str:
    """Return how to add an unknown type's package, or the closest names, to append to a sentence."""
    package, kind, name = (*type_name.split("/"), "", "")[:3]
    known_packages = {name.split("/")[0] for name in field_definitions()}
    # A package with a name of its own is custom, as in a bag of another workspace.
    if name and not get_close_matches(package, known_packages, cutoff=0.85):
        return (
            f": put the folder of the package {package}, with its {kind}/{name}.{kind}, beside "
            "the program, or into the workspace's src."
        )
    return did_you_mean(type_name, field_definitions(), 3) or ". Written like visualization_msgs/msg/Marker."


def _parse_definition(type_name: str) -> MessageDefinition:
    constants, fields = field_definitions()[type_name]
    return MessageDefinition(
        type_name,
        {name: bytes([int(value)]) if base == "byte" else value for name, base, value in constants},
        tuple(_field(type_name, name, desc) for name, desc in fields),
    )


FIRST_PARTS = {"msg": "", "srv": interface_files.SERVICE_PARTS[0], "action": interface_files.ACTION_PARTS[0]}


def interfaces(kind: str) -> list[str]:
    """List the types of a kind (msg, srv or action) by name."""
    suffix = FIRST_PARTS[kind]
    names = [
        name.removesuffix(suffix) for name in type_names() if f"/{kind}/" in name and name.endswith(suffix)
    ]
    # Sorted again, because _Goal follows the S of MoveGroupSequence.
    return sorted(name for name in names if "_" not in name.rsplit("/", 1)[1])


def event_definition(service: str) -> Any:
    """Return the definition of a service's event type, derived from request and response."""
    parts = (("request", f"{service}_Request"), ("response", f"{service}_Response"))
    fields = [(name, (_SEQUENCE, ((_NAME, part), 1))) for name, part in parts]
    return [], [("info", (_NAME, "service_msgs/msg/ServiceEventInfo")), *fields]


def _field(type_name: str, name: str, desc: Any) -> FieldDefinition:
    """Convert rosbags' tuples ``(kind, (inner, size))``; a base type is ``(1, (name, bound))``."""
    default = DEFAULTS.get((type_name, name))
    kind, detail = desc
    container, size = _CONTAINERS[kind], 0
    if container != "scalar":
        (kind, detail), size = detail
    base, string_bound = (detail, 0) if isinstance(detail, str) else detail
    return FieldDefinition(name, base, string_bound, container, size, default)


# The values of rosbags.interfaces.Nodetype.
_NAME, _SEQUENCE = 2, 4
_CONTAINERS: Mapping[int, Literal["scalar", "array", "sequence"]] = {
    1: "scalar",
    2: "scalar",
    3: "array",
    4: "sequence",
}


@dataclass(frozen=True, slots=True)
class Primitive:
    """A primitive type: IDL's name, the Python type, and for numbers the range and array code."""

    ros_name: str
    python: type
    # The type code for array.array and numpy; "" if ROS stores sequences of it as lists.
    code: str = ""
    # The range that ROS checks, for numbers only.
    low: float = 0
    high: float = 0
    # "integer" in the text "an integer in [-128, 127]"; "" if there is no range check.
    range_noun: str = ""

    @property
    def dtype(self) -> "np.dtype[np.generic]":
        """The numpy type of an element."""
        # Converted to a string like "<i8" and back, because numpy prints the dtype of the code "q",
        # although it is the default integer type. As a single call, mypy takes 4 s to combine
        # numpy's overloads.
        numpy_type: np.dtype[np.generic] = np.dtype(self.code) if self.code else np.dtype(np.bool_)
        return np.dtype(numpy_type.str)


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


# Type ids of FieldType: a nested message, and offsets for arrays and sequences.
_NESTED, _ARRAY, _BOUNDED, _UNBOUNDED = 1, 48, 96, 144
# The field of a type without fields.
_FILLER = "structure_needs_at_least_one_member"


@cache
def type_hash(type_name: str) -> str:
    """Return the hash `RIHS01_…` of a message or service type.

    Raise a CourseError if it is unknown.
    """
    return _store_with(type_name).hash_rihs01(type_name)


def describe_type(type_name: str) -> dict[str, dict[str, Any]]:
    """Describe a type and all types that it refers to, by name, as the structs that are hashed."""
    from rosbags.interfaces import Nodetype
    from rosbags.typesys.store import TIDMAP

    store = _store_with(type_name)
    filler = [(_FILLER, (Nodetype.BASE, ("uint8", 0)))]
    descriptions: dict[str, dict[str, Any]] = {}
    waiting = [type_name]
    while waiting:
        name = waiting.pop()
        fields: list[dict[str, Any]] = []
        for field, stored_form in store.fielddefs[name][1] or filler:
            form: Any = stored_form
            capacity, more = 0, 0
            if form[0] == Nodetype.ARRAY:
                form, capacity, more = form[1][0], form[1][1], _ARRAY
            elif form[0] == Nodetype.SEQUENCE:
                form, capacity = form[1]
                more = _BOUNDED if capacity else _UNBOUNDED
            kind, detail = form
            nested = detail if kind == Nodetype.NAME else ""
            string_bound = 0 if nested or detail[0] != "string" else detail[1]
            # The type ids of type_description_interfaces/msg/FieldType.
            base = _NESTED if nested else TIDMAP["bounded_string" if string_bound else detail[0]]
            sizes = {"capacity": capacity, "string_capacity": string_bound, "nested_type_name": nested}
            fields.append({"name": field, "type": {"type_id": base + more, **sizes}})
        descriptions[name] = {"type_name": name, "fields": fields}
        nested_types = {field["type"]["nested_type_name"] for field in fields} - {""}
        waiting += sorted(nested_types - descriptions.keys())
    return descriptions


def _store_with(type_name: str) -> "Typestore":
    """Return the store used for hashing, filled with all types known so far."""
    store = _hashed_types()
    request = f"{type_name}_Request"
    is_service = "/srv/" in type_name or type_name.endswith(("_SendGoal", "_GetResult"))
    # The lookup adds the type if it is in one of the student's packages.
    definition(request if is_service and not type_name.endswith(EVENT_PART) else type_name)
    for name, (_, fields) in field_definitions().items():
        if name not in store.fielddefs:
            store.fielddefs[name] = [], [(field, _to_hashed_form(form)) for field, form in fields]
    if request in store.fielddefs:
        from rosbags.interfaces import Nodetype

        # rosidl describes a service as a struct of its request, response and event.
        definitions = cast("dict[str, Any]", store.fielddefs)
        definitions[f"{type_name}_Event"] = event_definition(type_name)
        definitions[type_name] = (
            [],
            [
                (f"{part.lower()}_message", (Nodetype.NAME, f"{type_name}_{part}"))
                for part in ("Request", "Response", "Event")
            ],
        )
    return store


def is_known(type_name: str) -> bool:
    """Return whether a message or service type has already been read."""
    definitions = field_definitions()
    return type_name in definitions or f"{type_name}_Request" in definitions


@cache
def _hashed_types() -> "Typestore":
    """Return an empty store, which is used for hashing only."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.EMPTY)


def _to_hashed_form(form: Any) -> Any:
    """Return a field's type as rosidl hashes it: `char` in a .msg file is uint8, not IDL's char."""
    from rosbags.interfaces import Nodetype

    kind, detail = form
    if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        return kind, (_to_hashed_form(detail[0]), detail[1])
    return (kind, ("uint8", 0)) if form == (Nodetype.BASE, ("char", 0)) else form
