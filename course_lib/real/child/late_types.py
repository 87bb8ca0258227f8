"""Message types without a wheel on the real rclpy: type support made of ctypes callbacks, without a compiler.

rmw_fastrtps needs four things for a type: its DDS name, its hash, and functions that write and read
its bytes. Here these functions copy CDR bytes written in Python. This is how `tf2_msgs` and the
messages of a student's package, for which there are no wheels, are used with the real rclpy.

The structures below are those of rosidl 4.6 and Fast CDR 2.2. In other versions their layout may
differ, which would corrupt memory, so `environment` accepts only the pinned versions.
"""

import ctypes as ct
import importlib
import re
import struct
import sys
from array import array
from collections.abc import Callable, Mapping
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

ACTION_PARTS = ("_Goal", "_Result", "_Feedback")
# Little-endian CDR.
HEADER = b"\0\1\0\0"
# Format of `struct` and default value, by rosidl's name of the primitive.
PRIMITIVES: dict[str, tuple[str, Any]] = {
    "boolean": ("?", False),
    "octet": ("B", b"\0"),
    "char": ("B", 0),
    "float": ("f", 0.0),
    "double": ("d", 0.0),
    "int8": ("b", 0),
    "uint8": ("B", 0),
    "int16": ("h", 0),
    "uint16": ("H", 0),
    "int32": ("i", 0),
    "uint32": ("I", 0),
    "int64": ("q", 0),
    "uint64": ("Q", 0),
}


@cache
def parse_type(text: str) -> tuple[str, int | None]:
    """Return a field's element type and its count: None for a single value, 0 for a sequence."""
    if match := re.fullmatch(r"sequence<(.+?)(, \d+)?>", text):
        return match[1], 0
    if match := re.fullmatch(r"(.+)\[(\d+)\]", text):
        return match[1], int(match[2])
    return text, None


@cache
def nested_class(name: str) -> Any:
    """Return the class of a nested message, given as `geometry_msgs/Point`."""
    package, _, message = name.rpartition("/")
    # rosidl's names do not show whether a nested type is a message or a part of an action.
    kind = "action" if message.endswith(ACTION_PARTS) else "msg"
    return getattr(importlib.import_module(f"{package}.{kind}"), message)


def is_string(element: str) -> bool:
    """Return whether an element is a string, with or without a bound."""
    return element.partition("<")[0] == "string"


class _Writer:
    """Writes a message as little-endian CDR. `body` has the bytes after the header."""

    def __init__(self) -> None:
        self.body = bytearray()

    def write_primitives(self, code: str, values: Any) -> None:
        size = struct.calcsize(code)
        if len(values):
            self.body += bytes(-len(self.body) % size)
            self.body += struct.pack(f"<{len(values)}{code}", *values)

    def write_element(self, element: str, value: Any) -> None:
        if element in PRIMITIVES:
            self.write_primitives(PRIMITIVES[element][0], [value[0] if isinstance(value, bytes) else value])
        elif is_string(element):
            data = value.encode() + b"\0"
            self.write_primitives("I", [len(data)])
            self.body += data
        else:
            self.write_message(value)

    def write_message(self, message: Any) -> None:
        fields = message.get_fields_and_field_types()
        for name, text in fields.items():
            element, count = parse_type(text)
            value = getattr(message, name)
            if count is None:
                self.write_element(element, value)
                continue
            if count == 0:
                self.write_primitives("I", [len(value)])
            if element in PRIMITIVES and element != "octet":
                self.write_primitives(PRIMITIVES[element][0], value)
            else:
                for item in value:
                    self.write_element(element, item)
        if not fields:
            # CDR has no empty structures, so rosidl adds a byte.
            self.body.append(0)


class _Reader:
    """Reads a message from CDR bytes with their header, which has the byte order."""

    def __init__(self, data: bytes) -> None:
        self.order = "<" if data[1] & 1 else ">"
        self.body = data[len(HEADER) :]
        self.position = 0

    def read_primitives(self, code: str, count: int) -> tuple[Any, ...]:
        if not count:
            return ()
        form = f"{self.order}{count}{code}"
        self.position += -self.position % struct.calcsize(code)
        values = struct.unpack_from(form, self.body, self.position)
        self.position += struct.calcsize(form)
        return values

    def read_element(self, element: str) -> Any:
        if element in PRIMITIVES:
            (value,) = self.read_primitives(PRIMITIVES[element][0], 1)
            return bytes([value]) if element == "octet" else value
        if is_string(element):
            (size,) = self.read_primitives("I", 1)
            self.position += size
            return self.body[self.position - size : self.position].rstrip(b"\0").decode()
        return self.read_message(nested_class(element))

    def read_message(self, message_class: Any) -> Any:
        message = message_class()
        fields = message_class.get_fields_and_field_types()
        for name, text in fields.items():
            element, count = parse_type(text)
            if count is None:
                setattr(message, name, self.read_element(element))
                continue
            size = count or self.read_primitives("I", 1)[0]
            if element in PRIMITIVES and element != "octet":
                values = list(self.read_primitives(PRIMITIVES[element][0], size))
                default = getattr(message, name)
                # The wheels store arrays of numbers in containers with a fixed type, which must be
                # kept.
                if isinstance(default, list):
                    setattr(message, name, values)
                elif isinstance(default, array):
                    setattr(message, name, array(default.typecode, values))
                else:
                    # Only fields of the wheels have numpy arrays, so numpy is installed there.
                    import numpy as np

                    setattr(message, name, np.array(values, dtype=default.dtype))
            else:
                setattr(message, name, [self.read_element(element) for _ in range(size)])
        if not fields:
            self.position += 1
        return message


def serialize(message: Any) -> bytes:
    """Return a message as little-endian CDR bytes with their header."""
    writer = _Writer()
    writer.write_message(message)
    return HEADER + bytes(writer.body)


def deserialize(data: bytes, message_class: Any) -> Any:
    """Deserialize a message from CDR bytes with their header."""
    return _Reader(data).read_message(message_class)


FAST_RTPS, INTROSPECTION = b"rosidl_typesupport_fastrtps_c", b"rosidl_typesupport_introspection_c"
# Number of words of the C++ object Cdr that can contain its iterators.
CDR_WORDS = 26
ACTION_SERVICES = {"_SendGoal": "SendGoalService", "_GetResult": "GetResultService"}
_Pointer = ct.c_void_p
# Fields, constants, defaults and hash of each type.
Types = Mapping[str, Mapping[str, Any]]


def _pointers(*names: str) -> list[tuple[str, Any]]:
    return [(name, _Pointer) for name in names]


_DESCRIPTIONS = ("hash", "description", "sources")


class _String(ct.Structure):
    _fields_ = [("data", ct.c_char_p), ("size", ct.c_size_t), ("capacity", ct.c_size_t)]


class _Sequence(ct.Structure):
    _fields_ = [("data", _Pointer), ("size", ct.c_size_t), ("capacity", ct.c_size_t)]


class _Description(ct.Structure):
    _fields_ = [("type_name", _String), ("fields", _Sequence), ("referenced", _Sequence)]


class _Hash(ct.Structure):
    _fields_ = [("version", ct.c_uint8), ("value", ct.c_uint8 * 32)]


class _MessageSupport(ct.Structure):
    _fields_ = _pointers("identifier", "data", "find", *_DESCRIPTIONS)


class _ServiceSupport(ct.Structure):
    _fields_ = _pointers(
        "identifier",
        "data",
        "find",
        "request",
        "response",
        "event",
        "create_event",
        "destroy_event",
        *_DESCRIPTIONS,
    )


class _ActionSupport(ct.Structure):
    _fields_ = _pointers("goal", "result", "cancel", "feedback", "status", *_DESCRIPTIONS)


class _MessageCallbacks(ct.Structure):
    _fields_ = _pointers("namespace", "name", "serialize", "deserialize", "size", "max_size", "key")


class _ServiceCallbacks(ct.Structure):
    _fields_ = _pointers("namespace", "name", "request", "response")


class _MessageMembers(ct.Structure):
    """Members of a message, for introspection.

    Fast DDS builds a type object from them; an empty list suffices.
    """

    _fields_ = [
        *_pointers("namespace", "name"),
        ("count", ct.c_uint32),
        ("size", ct.c_size_t),
        ("has_key", ct.c_bool),
        *_pointers("members", "initialize", "finalize"),
    ]


class _Slot(ct.Structure):
    """A C message. Only its address is used, as the key of its CDR bytes in `_bytes`."""

    _fields_ = [("unused", ct.c_uint64)]


# Objects to which C code holds pointers, so Python must not delete them.
_live_objects: list[Any] = []
_slots: dict[int, _Slot] = {}
_bytes: dict[int, bytes] = {}
# The introspection type support of each message's type support.
_introspection: dict[int, int] = {}


def _keep_alive(structure: Any) -> int:
    _live_objects.append(structure)
    return ct.addressof(structure)


def _text(value: str | bytes) -> int:
    return _keep_alive(ct.create_string_buffer(value.encode() if isinstance(value, str) else value))


def _callback(
    result: Any,
    *arguments: Any,
    holds_gil: bool = False,
) -> Callable[[Callable[..., Any]], int]:
    """Turn a function into a C callback. The decorated name is the callback's address."""

    def decorate(function: Callable[..., Any]) -> int:
        pointer = (ct.PYFUNCTYPE if holds_gil else ct.CFUNCTYPE)(result, *arguments)(function)
        _live_objects.append(pointer)
        return ct.cast(pointer, _Pointer).value or 0

    return decorate


def _capsule(address: int) -> Any:
    create = ct.pythonapi.PyCapsule_New
    create.restype, create.argtypes = ct.py_object, [_Pointer, ct.c_char_p, _Pointer]
    return create(address, None, None)


_fast_cdr = ct.CDLL(str(Path(sys.prefix) / "lib" / "libfastcdr.so.2"))
_put = _fast_cdr._ZN8eprosima7fastcdr3Cdr15serialize_arrayEPKcm
_put.argtypes, _put.restype = [_Pointer, ct.c_char_p, ct.c_size_t], _Pointer
_begin = _fast_cdr._ZN8eprosima7fastcdr3Cdr18get_buffer_pointerEv
_begin.argtypes, _begin.restype = [_Pointer], _Pointer


@_callback(_Pointer, _Pointer, ct.c_char_p)
def _find(handle: int, identifier: bytes) -> int | None:
    if identifier == INTROSPECTION:
        return _introspection.get(handle)
    return handle if identifier == FAST_RTPS else None


@_callback(ct.c_bool, _Pointer, _Pointer)
def _serialize(message: int, cdr: int) -> bool:
    body = _bytes[message][4:]
    _put(cdr, body, len(body))
    return True


@_callback(ct.c_bool, _Pointer, _Pointer)
def _deserialize(cdr: int, message: int) -> bool:
    begin = _begin(cdr)
    # Each iterator of the object contains the start of the buffer and a position. The largest is
    # the end.
    addresses = (ct.c_size_t * CDR_WORDS).from_address(cdr)
    ends = [end for first, end in pairwise(addresses) if first == begin and end >= begin]
    _bytes[message] = ct.string_at(begin, max(ends) - begin)
    return True


@_callback(ct.c_uint32, _Pointer)
def _size(message: int) -> int:
    return len(_bytes[message]) - 4


@_callback(ct.c_size_t, ct.POINTER(ct.c_char))
def _max_size(bounds: Any) -> int:
    # Not bounded.
    bounds[0] = b"\0"
    return 4


@_callback(_Pointer, holds_gil=True)
def _create() -> int:
    slot = _Slot()
    address = ct.addressof(slot)
    _slots[address], _bytes[address] = slot, b""
    return address


@_callback(None, _Pointer, holds_gil=True)
def _destroy(message: int) -> None:
    _slots.pop(message, None)
    _bytes.pop(message, None)


@_callback(ct.c_bool, ct.py_object, _Pointer, holds_gil=True)
def _from_python(message: Any, address: int) -> bool:
    _bytes[address] = serialize(message)
    return True


def _descriptions(name: str, type_hash: str) -> list[int]:
    """Return functions for the type's hash, a description with only its name, and empty sources."""
    digest = _Hash(1, (ct.c_uint8 * 32)(*bytes.fromhex(type_hash.removeprefix("RIHS01_"))))
    text = name.encode()
    _live_objects.append(text)
    description = _Description(_String(text, len(text), len(text) + 1), _Sequence(), _Sequence())
    addresses = [_keep_alive(part) for part in (digest, description, _Sequence())]
    return [_callback(_Pointer, _Pointer)(lambda handle, address=address: address) for address in addresses]


def _message_support(name: str, type_hash: str) -> int:
    package, kind, message = name.split("/")
    callbacks = (_serialize, _deserialize, _size, _max_size)
    data = _MessageCallbacks(_text(f"{package}::{kind}"), _text(message), *callbacks, None)
    about = _descriptions(name, type_hash)
    support = _keep_alive(_MessageSupport(_text(FAST_RTPS), _keep_alive(data), _find, *about))
    names = _text(f"{package}__{kind}"), _text(message)
    members = _MessageMembers(*names, 0, ct.sizeof(_Slot), False, None, None, None)
    _introspection[support] = _keep_alive(
        _MessageSupport(_text(INTROSPECTION), _keep_alive(members), _find, *about)
    )
    return support


def _create_class(name: str, support: int, namespace: Mapping[str, Any]) -> Any:
    """Return a class as rosidl generates it. rclpy reads the type support from its metaclass."""
    short_name = name.rpartition("/")[2]
    attributes = {
        "__import_type_support__": classmethod(lambda cls: None),
        "_TYPE_SUPPORT": _capsule(support),
    }
    return type(f"Metaclass_{short_name}", (type,), attributes)(short_name, (), dict(namespace))


def _reject_instances(kind: str) -> Callable[..., None]:
    """Return the constructor of a service's or an action's class, which has no instances."""

    def initialize(self: Any, *args: Any, **kwargs: Any) -> None:
        raise NotImplementedError(f"{kind} classes can not be instantiated")

    return initialize


def _default(text: str) -> Any:
    element, count = parse_type(text)
    if count is not None:
        return [_default(element) for _ in range(count)]
    if element in PRIMITIVES:
        return PRIMITIVES[element][1]
    return "" if is_string(element) else nested_class(element)()


def _field(name: str, text: str) -> property:
    """Return the property of a field, which raises rosidl's AssertionError for another type."""
    element, count = parse_type(text)

    def set_value(self: Any, value: Any) -> None:
        values = [value] if count is None else list(value)
        if element in PRIMITIVES:
            kind = type(PRIMITIVES[element][1])
            kinds = (int, float) if kind is float else (kind,)
            is_right = all(isinstance(item, kinds) or hasattr(item, "dtype") for item in values)
            expected = kind.__name__
        elif is_string(element):
            is_right, expected = all(isinstance(item, str) for item in values), "str"
        else:
            is_right = all(isinstance(item, nested_class(element)) for item in values)
            expected = element.rpartition("/")[2]
        assert is_right, f"The '{name}' field must be of type '{expected}'"
        assert not count or len(values) == count, f"The '{name}' field must have {count} values"
        setattr(self, f"_{name}", value)

    return property(lambda self: getattr(self, f"_{name}"), set_value)


def _message_class(name: str, about: Mapping[str, Any]) -> type:
    """Return the class of a message. Its metaclass has the attributes that rclpy uses."""
    package, kind, message = name.split("/")
    fields, defaults = about["fields"], about["defaults"]

    def initialize(self: Any, **values: Any) -> None:
        for field, text in fields.items():
            value = values.pop(field) if field in values else defaults.get(field, _default(text))
            setattr(self, field, value)
        assert not values, f"Invalid arguments passed to constructor: {', '.join(sorted(values))}"

    def represent(self: Any) -> str:
        return f"{package}.{kind}.{message}({', '.join(f'{f}={getattr(self, f)!r}' for f in fields)})"

    def equal(self: Any, other: object) -> bool:
        return type(self) is type(other) and all(getattr(self, f) == getattr(other, f) for f in fields)

    namespace: dict[str, Any] = {
        **about["constants"],
        **{field: _field(field, text) for field, text in fields.items()},
        "__slots__": [f"_{field}" for field in fields],
        "__module__": about["module"],
        "__init__": initialize,
        "__repr__": represent,
        "__eq__": equal,
        "_fields_and_field_types": fields,
        "get_fields_and_field_types": classmethod(lambda cls: dict(fields)),
    }
    created: type = _create_class(name, _message_support(name, about["hash"]), namespace)
    metaclass: Any = type(created)

    @_callback(ct.py_object, _Pointer, holds_gil=True)
    def to_python(address: int) -> Any:
        return deserialize(_bytes[address], created)

    metaclass._CREATE_ROS_MESSAGE, metaclass._DESTROY_ROS_MESSAGE = _capsule(_create), _capsule(_destroy)
    metaclass._CONVERT_FROM_PY, metaclass._CONVERT_TO_PY = _capsule(_from_python), _capsule(to_python)
    return created


def _support_of(message_class: Any) -> int:
    capsule = type(message_class)._TYPE_SUPPORT
    get = ct.pythonapi.PyCapsule_GetPointer
    get.restype, get.argtypes = _Pointer, [ct.py_object, ct.c_char_p]
    name = ct.pythonapi.PyCapsule_GetName
    name.restype, name.argtypes = ct.c_char_p, [ct.py_object]
    return int(get(capsule, name(capsule)))


def _service_class(name: str, module: str, request: type, response: type, type_hash: str) -> type:
    package, kind, service = name.split("/")
    ends = _support_of(request), _support_of(response)
    data = _ServiceCallbacks(_text(f"{package}::{kind}"), _text(service), *ends)
    # Without service introspection no event message is created, so the request can replace its
    # type.
    about = _descriptions(name, type_hash)
    support = _ServiceSupport(_text(FAST_RTPS), _keep_alive(data), _find, *ends, ends[0], None, None, *about)
    namespace = {
        "Request": request,
        "Response": response,
        "__module__": module,
        "__init__": _reject_instances("Service"),
    }
    created: type = _create_class(name, _keep_alive(support), namespace)
    return created


def _action_class(name: str, module: str, classes: Mapping[str, type], type_hash: str) -> type:
    """Return the class of an action, which consists of two services of its own and one of action_msgs."""
    from action_msgs.msg import GoalStatusArray
    from action_msgs.srv import CancelGoal

    wheels: tuple[Any, ...] = (GoalStatusArray, CancelGoal)
    for wheel in wheels:
        type(wheel).__import_type_support__()
    services = {attribute: classes[f"{name}{suffix}"] for suffix, attribute in ACTION_SERVICES.items()}
    transport = {
        **services,
        "FeedbackMessage": classes[f"{name}_FeedbackMessage"],
        "CancelGoalService": CancelGoal,
        "GoalStatusMessage": GoalStatusArray,
    }
    order = (
        "SendGoalService",
        "GetResultService",
        "CancelGoalService",
        "FeedbackMessage",
        "GoalStatusMessage",
    )
    addresses = [_support_of(transport[name]) for name in order]
    support = _ActionSupport(*addresses, *_descriptions(name, type_hash))
    namespace = {
        **{part: classes[f"{name}_{part}"] for part in ("Goal", "Result", "Feedback")},
        "Impl": type("Impl", (), transport),
        "__module__": module,
        "__init__": _reject_instances("Action"),
    }
    created: type = _create_class(name, _keep_alive(support), namespace)
    return created


def create_classes(types: Types) -> dict[str, type]:
    """Return all type classes of a package by name."""
    classes = {name: _message_class(name, about) for name, about in types.items() if "fields" in about}
    for name, about in types.items():
        if about.get("kind") == "service":
            parts = classes[f"{name}_Request"], classes[f"{name}_Response"]
            classes[name] = _service_class(name, about["module"], *parts, about["hash"])
    # Actions consist of services, so they are created last.
    for name, about in types.items():
        if about.get("kind") == "action":
            classes[name] = _action_class(name, about["module"], classes, about["hash"])
    return classes
