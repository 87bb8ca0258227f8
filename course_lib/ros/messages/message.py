"""Message classes, created from definitions on first use, and the modules that contain them.

Messages such as points and colors are created by the million, so each class gets a constructor
and a factory that are compiled for its fields. The kind of each field (`Kind`) determines how its values
are checked, stored, constructed and serialized.

The checks and their error texts are those of rosidl_generator_py (resource/_msg.py.em). Jazzy
disables them, and a publisher then aborts the whole process when a value has the wrong type; here
they are enabled, as in Humble. Lists are stored by reference, so `to_wire` checks them when they
are sent. It joins lists of bools and bytes, which `from_wire` splits again.
"""

import os
import sys
from array import array
from collections import UserString
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence, Set
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import cache
from inspect import Parameter, Signature
from keyword import iskeyword
from math import isinf
from operator import attrgetter
from types import ModuleType
from typing import Any, ClassVar, Self, cast

import numpy as np

from course_lib.errors import CourseError
from course_lib.ros.messages.definitions import (
    EVENT_PART,
    PRIMITIVES,
    UNSUPPORTED,
    FieldDefinition,
    Primitive,
    definition,
    type_names,
)
from course_lib.ros.messages.interface_files import ACTION_PARTS, PLACEHOLDER, SERVICE_PARTS
from course_lib.ros.mistakes import Mistake, marked

# The kit checks each assignment by default, as Humble did. Jazzy leaves the check to publishing.
CHECKED = os.environ.get("ROS_PYTHON_CHECK_FIELDS", "1") != "0"
# Stands for a field that was not passed.
_UNSET = object()
# Raises AssertionError if the value is invalid.
Check = Callable[[Any], None]
Fits = Callable[[Any], bool]
Convert = Callable[[Any], Any]
# The types that Python converts to a number in an array.
_CONVERTED: dict[type, tuple[type, ...]] = {
    float: (float, int, np.floating, np.integer),
    int: (int, np.integer),
}


def make_check(field: FieldDefinition, rule: str, fits: Fits) -> Check:
    """Return a check with the error "The 'x' field must be …"."""

    def check(value: Any) -> None:
        if not fits(value):
            raise AssertionError(f"The '{field.name}' field must be {rule}")

    return check


def scalar_check(field: FieldDefinition, primitive: Primitive) -> Check:
    """Return the check of a number, bool, string or byte, which is a ``bytes`` of length 1."""
    python, max_length = primitive.python, field.string_bound
    if python is bytes:
        rule = "of type 'bytes' or 'ByteString' with length 1"
        return make_check(field, rule, lambda value: isinstance(value, bytes | bytearray) and len(value) == 1)
    if max_length:
        rule = f"string value not longer than {max_length}"
        kinds = str | UserString
        return make_check(field, rule, lambda value: isinstance(value, kinds) and len(value) <= max_length)
    if not primitive.range_noun:
        return make_check(field, f"of type '{python.__name__}'", lambda value: isinstance(value, python))
    article = "an" if python is int else "a"
    limits = f"{article} {primitive.range_noun} in [{primitive.low}, {primitive.high}]"

    # The cast prevents mypy from narrowing the value to object.
    low, high, exact = primitive.low, primitive.high, cast("Any", python)

    def check_number(value: Any) -> None:
        # A shortcut for nearly all values.
        if type(value) is exact and low <= value <= high:
            return
        if not isinstance(value, python):
            raise AssertionError(f"The '{field.name}' field must be of type '{python.__name__}'")
        if not _is_in_range(value, primitive):
            raise AssertionError(f"The '{field.name}' field must be {limits}")

    return check_number


def numbers_check(field: FieldDefinition, primitive: Primitive) -> Check:
    """Return the check of a sequence of numbers: by type code for an array.array, else by element.

    All values that `array.array(code, value)` converts are accepted, as on Jazzy: integers for
    floats, numpy numbers, arrays of another type code, one-dimensional numpy arrays.
    """
    element_types = _CONVERTED[primitive.python]
    elements = _describe_collection(field, primitive.python, primitive)
    ranged = primitive if primitive.range_noun else None
    numpy_kinds = "iuf" if primitive.python is float else "iu"

    def fits(value: Any) -> bool:
        return (
            isinstance(value, Collection)
            and not isinstance(value, str | UserString | Mapping)
            and _is_valid_length(value, field)
            and all(isinstance(element, element_types) for element in value)
            and (ranged is None or all(_is_in_range(element, ranged) for element in value))
        )

    check_elements = make_check(field, elements, fits)

    def check(value: Any) -> None:
        if isinstance(value, array) and value.typecode == primitive.code:
            if not _is_valid_length(value, field):
                raise AssertionError(f"The '{field.name}' array.array() must have a size <= {field.size}")
        elif (
            isinstance(value, bytes | bytearray) and primitive.code == "B" and _is_valid_length(value, field)
        ):
            # Bytes are always in range, and an image has a hundred thousand of them.
            return
        elif isinstance(value, np.ndarray) and value.ndim == 1 and value.dtype.kind in numpy_kinds:
            # If the minimum and the maximum are in range, all values are.
            ends = [value.min(), value.max()] if value.size and primitive.python is int else []
            if not (_is_valid_length(value, field) and all(_is_in_range(end, primitive) for end in ends)):
                check_elements(value)
        else:
            check_elements(value)

    return check


def _is_in_range(value: Any, primitive: Primitive) -> bool:
    if primitive.python is float:
        return not (value < primitive.low or value > primitive.high) or isinf(value)
    return bool(primitive.low <= value <= primitive.high)


def _is_valid_length(value: Collection[Any], field: FieldDefinition) -> bool:
    if field.container == "array":
        return len(value) == field.size
    return not field.size or len(value) <= field.size


def _describe_collection(field: FieldDefinition, item: type, primitive: Primitive | None) -> str:
    phrases = ["a set or sequence"]
    if field.size:
        phrases.append(f"with length {'<= ' if field.container == 'sequence' else ''}{field.size}")
    if field.string_bound:
        phrases.append(f"and each string value not longer than {field.string_bound}")
    phrases.append(f"and each value of type '{item.__name__}'")
    if primitive is not None and primitive.range_noun:
        style = ".6f" if primitive.python is float else "d"
        limits = f"[{primitive.low:{style}}, {primitive.high:{style}}]"
        phrases.append(f"and each {primitive.range_noun} in {limits}")
    return " ".join(phrases)


@dataclass(frozen=True, slots=True)
class Kind:
    """The conversions of a field's values. None means no conversion."""

    default: Callable[[], Any]
    check: Check
    # Converts a constructor's argument before it is passed to the setter.
    construct: Convert | None = None
    # Converts the value that the setter stores.
    keep: Convert | None = None
    to_wire: Convert | None = None
    from_wire: Convert | None = None
    # All values of exactly this type are valid and stored unchanged.
    exact: type | None = None


def kind_of(field: FieldDefinition) -> Kind:
    """Return a field's kind, with the default of its definition."""
    if field.is_message:
        item = message_class(field.base)
        if field.container == "scalar":
            rule = f"a sub message of type '{item.__name__}'"
            return Kind(item, make_check(field, rule, lambda value: isinstance(value, item)), exact=item)
        return _list_kind(field, item, None)
    primitive = PRIMITIVES[field.base]
    if field.container == "scalar":
        default = _default_factory(primitive) if field.default is None else lambda: field.default
        is_double = primitive.python is float and primitive.high == sys.float_info.max
        is_free = primitive.python in (bool, str) and not field.string_bound
        exact = primitive.python if is_double or is_free else None
        return Kind(default, scalar_check(field, primitive), exact=exact)
    if primitive.code:
        kind = (_array_kind if field.container == "array" else _sequence_kind)(field, primitive)
    else:
        kind = _list_kind(field, primitive.python, primitive)
    if field.default is None:
        return kind
    return replace(kind, default=lambda: (kind.construct or list)(field.default))


def _default_factory(primitive: Primitive) -> Callable[[], Any]:
    return (lambda: b"\x00") if primitive.python is bytes else primitive.python


def _sequence_kind(field: FieldDefinition, primitive: Primitive) -> Kind:
    """Return the kind of a numeric sequence, stored as an array.array.

    An assigned array.array of the right type is stored without a copy; other values are copied.
    """
    code, dtype = primitive.code, primitive.dtype

    def pack(value: Any) -> "array[Any]":
        if not isinstance(value, np.ndarray) or value.ndim != 1:
            return array(code, value)
        return array(code, np.ascontiguousarray(value, dtype).tobytes())

    return Kind(
        default=lambda: array(code),
        check=numbers_check(field, primitive),
        construct=pack,
        keep=lambda value: value if isinstance(value, array) and value.typecode == code else pack(value),
    )


def _array_kind(field: FieldDefinition, primitive: Primitive) -> Kind:
    """Return the kind of a numeric array of fixed length, stored as a numpy array.

    An assigned numpy array of the right type is stored without a copy. It is checked by its dtype
    and shape, any other value by its elements.
    """
    dtype = primitive.dtype
    check_elements = numbers_check(field, primitive)

    def check(value: Any) -> None:
        if not isinstance(value, np.ndarray):
            check_elements(value)
        elif value.dtype.kind not in ("iuf" if primitive.python is float else "iu"):
            raise AssertionError(
                f"The '{field.name}' numpy.ndarray() must have the dtype of 'numpy.{dtype.name}'"
            )
        elif value.shape != (field.size,):
            # This includes matrices, of which Jazzy sends one column and undefined bytes.
            raise AssertionError(f"The '{field.name}' numpy.ndarray() must have a size of {field.size}")
        elif value.dtype != dtype:
            check_elements(value)

    return Kind(
        default=lambda: np.zeros(field.size, dtype),
        check=check,
        construct=lambda value: np.array(value, dtype),
        keep=lambda value: np.asarray(value, dtype),
    )


def _list_kind(field: FieldDefinition, item: type, primitive: Primitive | None) -> Kind:
    """Return the kind of a list of messages or strings. `primitive` has the range of numbers.

    The list is stored by reference, so elements that a program appends are checked only when it is
    sent.
    """
    ranged = primitive if primitive is not None and primitive.range_noun else None

    def fits(value: Any) -> bool:
        return (
            (isinstance(value, Sequence | Set) or (isinstance(value, np.ndarray) and value.ndim == 1))
            and not isinstance(value, str | UserString)
            and _is_valid_length(value, field)
            and all(isinstance(element, item) for element in value)
            and (not field.string_bound or all(len(element) <= field.string_bound for element in value))
            and (ranged is None or all(_is_in_range(element, ranged) for element in value))
        )

    check = make_check(field, _describe_collection(field, item, primitive), fits)
    send, receive = _LISTS.get(field.base, (None, None))

    is_free = field.container == "sequence" and not field.size and not field.string_bound
    element_types = {item}

    def to_wire(value: Any) -> Any:
        if not (is_free and type(value) is list and (not value or set(map(type, value)) == element_types)):
            check(value)
        return value if send is None else send(value)

    new = item if primitive is None else _default_factory(primitive)
    length = field.size if field.container == "array" else 0
    return Kind(
        default=lambda: [new() for _ in range(length)], check=check, to_wire=to_wire, from_wire=receive
    )


# Serialization of lists of bools and bytes.
_LISTS: Mapping[str, tuple[Convert, Convert]] = {
    "bool": (bytes, lambda octets: [octet != 0 for octet in octets]),
    "byte": (b"".join, lambda octets: [bytes([octet]) for octet in octets]),
}


def constructor(kinds: Mapping[str, Kind], general: Callable[..., None]) -> Callable[..., None]:
    """Compile an `__init__` like `general` that stores values directly if they need no check."""
    if any(map(iskeyword, kinds)):
        return general
    scope: dict[str, Any] = {
        "_unset": _UNSET,
        "_general": general,
        "_type": type,
        # A field may be named `type`.
    }
    body = ["if _args or _unknown or check_fields is not True:"]
    items = "".join(f"{name!r}: {name}, " for name in kinds)
    body += [
        f"    _given = {{name: value for name, value in {{{items}}}.items() if value is not _unset}}",
        "    return _general(_self, *_args, check_fields=check_fields, **_given, **_unknown)",
        "_self._check_fields = True",
    ]
    for name, kind in kinds.items():
        # Immutable defaults can be shared by all messages.
        shares = kind.exact in (bool, float, str) or kind.default is int
        scope |= {
            f"_{name}_default": kind.default() if shares else kind.default,
            f"_{name}_exact": kind.exact,
            f"_{name}_of": kind.construct,
        }
        body += [f"if {name} is _unset: _self._{name} = _{name}_default{'' if shares else '()'}"]
        if kind.exact is not None:
            body += [f"elif _type({name}) is _{name}_exact: _self._{name} = {name}"]
        body += [f"else: _self.{name} = {name if kind.construct is None else f'_{name}_of({name})'}"]
    parameters = (f"check_fields={CHECKED}", *(f"{name}=_unset" for name in kinds))
    return compile_function("__init__", f"_self, *_args, {', '.join(parameters)}, **_unknown", body, scope)


def compile_factory(cls: type) -> Callable[..., Any]:
    """Compile a function that creates a message, including nested ones, from deserialized values."""
    scope: dict[str, Any] = {}
    values: list[str] = []
    body = factory_lines(cls, "m", scope, values)
    return compile_function("make", ", ".join(values), [*body, "return m"], scope)


def factory_lines(cls: Any, name: str, scope: dict[str, Any], values: list[str]) -> list[str]:
    """Return the lines that create one message under a name.

    Add the objects that they use to `scope`.
    """
    scope |= {f"{name}_new": cls.__new__, f"{name}_cls": cls}
    body = [f"{name} = {name}_new({name}_cls)", f"{name}._check_fields = {CHECKED}"]
    for field, kind in cls._KINDS.items():
        inner = f"{name}_{field}"
        if hasattr(kind.exact, "_KINDS"):
            body += [*factory_lines(kind.exact, inner, scope, values), f"{name}._{field} = {inner}"]
            continue
        values.append(f"v{len(values)}")
        scope[f"{inner}_of"] = kind.from_wire
        body += [f"{name}._{field} = {values[-1] if kind.from_wire is None else f'{inner}_of({values[-1]})'}"]
    if not cls._KINDS:
        # The value of the placeholder in a message without fields.
        values.append(f"v{len(values)}")
    return body


def compile_function(
    name: str, arguments: str, body: Iterable[str], scope: dict[str, Any]
) -> Callable[..., Any]:
    """Compile a function from these lines, with `scope` as its globals."""
    lines = "\n".join(f"    {line}" for line in body)
    # All names are from validated definitions, so the source cannot contain other code.
    source = f"def {name}({arguments}):\n{lines}"
    # The file name is in the kit, so that tracebacks leave its frames out.
    exec(compile(source, f"{__file__}:{name}", "exec"), scope)
    function: Callable[..., Any] = scope[name]
    return function


_ATOMS = {bool, int, float, str, bytes}


class _SlotTypes:
    """A descriptor for the fields' types as objects of rosidl_parser, created on access."""

    def __get__(self, message: object, kind: type["RosMessage"]) -> tuple[Any, ...]:
        from course_lib.ros.messages import idl

        types: list[Any] = []
        for field in definition(kind._TYPE_NAME).fields:
            single: idl.AbstractNestableType
            if field.name == PLACEHOLDER:
                continue
            if field.is_message:
                package, folder, name = field.base.split("/")
                single = idl.NamespacedType([package, folder], name)
            elif field.base == "string":
                bound = field.string_bound
                single = idl.BoundedString(bound) if bound else idl.UnboundedString()
            else:
                single = idl.BasicType(PRIMITIVES[field.base].ros_name)
            if field.container == "scalar":
                types.append(single)
            elif field.container == "array":
                types.append(idl.Array(single, field.size))
            elif field.size:
                types.append(idl.BoundedSequence(single, field.size))
            else:
                types.append(idl.UnboundedSequence(single))
        return tuple(types)


class _MessageMeta(type):
    """Base class of the metaclasses of message classes, which keep their constants and fields.

    A program that forgets the parentheses, as in `marker = Marker`, sets fields of the class. In a
    notebook, a replaced descriptor would break all messages of this type until the kernel restarts.
    The metaclass of each class has a property for each constant, which Python does not set.
    """

    # In ROS the functions that serialize messages. Message classes need this attribute.
    _TYPE_SUPPORT: ClassVar[object] = True

    def __setattr__(cls, name: str, value: object) -> None:
        if name not in vars(cls).get("_KINDS", ()):
            super().__setattr__(name, value)


class RosMessage(metaclass=_MessageMeta):
    """Base class of messages. The class stores the kinds of its fields, the slots store the values.

    Without `check_fields`, assignments are not checked. That is the default in Jazzy, where
    publishing an invalid message aborts the program, and in the kit if ROS_PYTHON_CHECK_FIELDS is
    0. A positional argument raises a TypeError as in Python; an unknown field, or an invalid
    value, an AssertionError with ROS's text.
    """

    __slots__ = ()
    _TYPE_NAME: ClassVar[str]  # "visualization_msgs/msg/Marker"
    _KINDS: ClassVar[Mapping[str, Kind]]
    _SLOTS: ClassVar[Sequence[str]]
    SLOT_TYPES = _SlotTypes()
    _fields_and_field_types: ClassVar[Mapping[str, str]]
    _check_fields: bool

    def __init__(self, *positional: Any, check_fields: bool = CHECKED, **values: Any) -> None:
        if positional:
            problem = f"takes 1 positional argument but {1 + len(positional)} were given"
            error = TypeError(f"{type(self).__name__}.__init__() {problem}")
            raise marked(error, Mistake.UNNAMED_FIELD)
        self._check_fields = check_fields  # type: ignore[misc]  # its slot is made by make_class
        unknown = values.keys() - self._KINDS.keys()
        if unknown and check_fields:
            raise AssertionError(f"Invalid arguments passed to constructor: {', '.join(sorted(unknown))}")
        for name, kind in self._KINDS.items():
            if name not in values:
                setattr(self, "_" + name, kind.default())
            elif kind.construct is None:
                setattr(self, name, values[name])
            else:
                setattr(self, name, kind.construct(values[name]))

    def __repr__(self) -> str:
        # The name of a student's subclass is in the student's module.
        modules = type(self).__module__.split(".")[:-1]
        name = ".".join([*modules, type(self).__name__])
        values = {field: getattr(self, field) for field in self._KINDS}
        # As in ROS, an array.array is printed as a list.
        plain = {f: value.tolist() if isinstance(value, array) else value for f, value in values.items()}
        return f"{name}({', '.join(f'{f}={value!r}' for f, value in plain.items())})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, self.__class__):
            return False
        pairs = ((getattr(self, name), getattr(other, name)) for name in self._KINDS)
        return all(
            np.array_equal(value, other_value) if isinstance(value, np.ndarray) else value == other_value
            for value, other_value in pairs
        )

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        """Copy the slots directly.

        The general way of Python, by pickling, takes several times as long.
        """
        copy = self.__class__.__new__(self.__class__)
        memo[id(self)] = copy
        for slot in self._SLOTS:
            value = getattr(self, slot)
            setattr(copy, slot, value if type(value) in _ATOMS else deepcopy(value, memo))
        # Instances of subclasses have further attributes.
        if hasattr(self, "__dict__"):
            vars(copy).update(deepcopy(vars(self), memo))
        return copy

    # As in ROS, messages are mutable and not hashable.
    __hash__ = None  # type: ignore[assignment]

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Return the fields' types as ROS writes them, like ``sequence<geometry_msgs/Point>``."""
        return dict(cls._fields_and_field_types)


def module_of_type(type_name: str) -> str:
    """Return the module that rosidl creates for a type, like ``std_msgs.msg._u_int8_multi_array``."""
    from re import sub

    package, folder, name = type_name.split("/")
    # The parts of a service or action share one module.
    base_name = name.split("_")[0]
    snake_case = sub("([a-z0-9])([A-Z])", r"\1_\2", sub("(.)([A-Z][a-z]+)", r"\1_\2", base_name)).lower()
    return f"{package}.{folder}._{snake_case}"


def ros_type(field: FieldDefinition) -> str:
    """Return a field's type as get_fields_and_field_types() does."""
    if field.is_message:
        package, _, name = field.base.split("/")
        base = f"{package}/{name}"
    else:
        base = PRIMITIVES[field.base].ros_name
    bounded = f"{base}<{field.string_bound}>" if field.string_bound else base
    size = f", {field.size}" if field.size else ""
    return {
        "scalar": bounded,
        "array": f"{bounded}[{field.size}]",
        "sequence": f"sequence<{bounded}{size}>",
    }[field.container]


def _accessor(name: str, kind: Kind) -> property:
    slot, check, keep, exact = "_" + name, kind.check, kind.keep, kind.exact

    def assign(self: RosMessage, value: Any) -> None:
        if self._check_fields and type(value) is not exact:
            check(value)
        setattr(self, slot, value if keep is None else keep(value))

    return property(attrgetter(slot), assign, doc=f"Message field '{name}'.")


# Packages of which a class has been created.
loaded = set[str]()


@cache
def message_class(type_name: str) -> type[RosMessage]:
    """Return the class of a type such as ``std_msgs/msg/String``.

    A CourseError lists the closest names.
    """
    loaded.add(type_name.partition("/")[0])
    message_definition = definition(type_name)
    name = type_name.rsplit("/", 1)[1]
    fields = [field for field in message_definition.fields if field.name != PLACEHOLDER]
    slots = [*("_" + field.name for field in fields), "_check_fields"]
    kinds = {field.name: kind_of(field) for field in fields}
    defaults = {f"{f.name.upper()}__DEFAULT": f.default for f in fields if f.default is not None}
    constants = "".join(f"\n  {constant}" for constant in message_definition.constants)
    namespace = {
        "__doc__": f"Message class '{name}'." + (f"\n\nConstants:{constants}\n" if constants else ""),
        "__signature__": Signature([Parameter(kind, Parameter.KEYWORD_ONLY, default=...) for kind in kinds]),
        "__module__": module_of_type(type_name),
        "__slots__": slots,
        "_TYPE_NAME": type_name,
        "_KINDS": kinds,
        "_SLOTS": slots,
        "__init__": constructor(kinds, RosMessage.__init__),
        "_fields_and_field_types": {field.name: ros_type(field) for field in fields},
    }
    accessors = {name: _accessor(name, kind) for name, kind in kinds.items()}
    # As in ROS, each class has a metaclass, whose name is in Python's errors about the class, and
    # whose properties protect the constants.
    values = {**message_definition.constants, **defaults}
    protected = {constant: _constant(value) for constant, value in values.items()}
    home = {"__module__": namespace["__module__"]}
    metaclass = type(f"Metaclass_{name}", (_MessageMeta,), {**home, **protected})
    created: type[RosMessage] = metaclass(name, (RosMessage,), {**namespace, **values, **accessors})
    return created


def _constant(value: object) -> property:
    """Return the property of a metaclass for a constant, which cannot be assigned."""
    return property(lambda cls: value)


def type_name(message: RosMessage | type[RosMessage]) -> str:
    """Return the type of a message or its class, such as ``std_msgs/msg/String``.

    Raises:
        CourseError: The object is not a message.
    """
    name = getattr(message, "_TYPE_NAME", None)
    if not isinstance(name, str):
        raise CourseError(f"{message!r} is not a ROS message type: import one, like std_msgs.msg.String")
    return name


class _InterfaceMeta(type):
    """Base class of the metaclasses of services and actions, which cannot be instantiated."""

    _TYPE_SUPPORT: ClassVar[object] = True

    def __getattr__(cls, name: str) -> type[RosMessage]:
        """Create the `Event` class of a service on access, because few programs need it."""
        if name != "Event" or "Request" not in vars(cls):
            raise AttributeError(f"type object {cls.__name__!r} has no attribute {name!r}")
        return message_class(f"{vars(cls)['_TYPE_NAME']}{EVENT_PART}")


@cache
def service_class(type_name: str) -> type:
    """Return the class of a service, like ``std_srvs/srv/Trigger``, with `Request` and `Response`."""
    return _container_class(type_name, SERVICE_PARTS)


@cache
def action_class(type_name: str) -> type:
    """Return the class of an action such as ``example_interfaces/action/Fibonacci``.

    Its attributes are `Goal`, `Result` and `Feedback`. `Impl` has the types of its services and
    topics.
    """
    transport = {
        "SendGoalService": service_class(f"{type_name}_SendGoal"),
        "GetResultService": service_class(f"{type_name}_GetResult"),
        "FeedbackMessage": message_class(f"{type_name}_FeedbackMessage"),
        "CancelGoalService": service_class("action_msgs/srv/CancelGoal"),
        "GoalStatusMessage": message_class("action_msgs/msg/GoalStatusArray"),
    }
    return _container_class(type_name, ACTION_PARTS, Impl=type("Impl", (), transport))


def _container_class(type_name: str, parts: tuple[str, ...], **attributes: Any) -> type:
    """Create the class of a service or an action, which contains messages."""
    name = type_name.rsplit("/", 1)[1]

    def initialize(self: object) -> None:
        kind = "Action" if hasattr(self, "Goal") else "Service"
        raise NotImplementedError(f"{kind} classes can not be instantiated")

    # Python's errors about wrong arguments contain this name.
    initialize.__qualname__ = f"{name}.__init__"
    contents = {part[1:]: message_class(type_name + part) for part in parts}
    home = {"__module__": module_of_type(type_name), "_TYPE_NAME": type_name}
    metaclass = type(f"Metaclass_{name}", (_InterfaceMeta,), {"__module__": home["__module__"]})
    created: type = metaclass(name, (), {**home, **contents, **attributes, "__init__": initialize})
    return created


def fill_module(module: ModuleType) -> None:
    """Add the classes of a package to its ``msg``, ``srv`` or ``action`` module, like ``std_msgs.msg``.

    A class is created on first access: creating all classes of a package takes longer than a small
    program runs. Each class is also in the private module where rosidl has it,
    ``std_msgs.msg._string``, which pickled messages and some programs refer to.
    """
    prefix = module.__name__.replace(".", "/") + "/"
    public, homes = dict[str, str](), dict[str, dict[str, str]]()
    for name in (name for name in type_names() if name.startswith(prefix)):
        home = homes.setdefault(module_of_type(name), {})
        home[name.removeprefix(prefix)] = name
        if not module.__name__.endswith(".msg"):
            # For example std_srvs.srv.SetBool_Request.
            public[name.removeprefix(prefix)] = name
        # The first part of a service or action represents the whole class, which programs import.
        first = next((part for part in (SERVICE_PARTS[0], ACTION_PARTS[0]) if name.endswith(part)), "")
        if first or "/msg/" in name:
            base_name = name.removeprefix(prefix).removesuffix(first)
            home[base_name] = public[base_name] = name
    for full_name, types in homes.items():
        submodule = sys.modules.setdefault(full_name, ModuleType(full_name))
        _make_lazy(submodule, types)
        vars(module)[full_name.rpartition(".")[2]] = submodule
    _make_lazy(module, public)


def _make_lazy(module: ModuleType, types: Mapping[str, str]) -> None:
    """Let a module create its classes on access. `types` maps names of classes to types."""
    module_name = module.__name__

    def get(name: str) -> Any:
        if name not in types:
            raise AttributeError(f"module {module_name!r} has no attribute {name!r}")
        type_name = types[name]
        if type_name.endswith(f"/{name}"):
            created: type = message_class(type_name)
        else:
            make_interface = service_class if type_name.endswith(SERVICE_PARTS[0]) else action_class
            created = make_interface(type_name.rpartition("/")[0] + f"/{name}")
        setattr(module, name, created)
        return created

    vars(module)["__getattr__"] = get
    vars(module)["__dir__"] = lambda: sorted({*vars(module), *types} - {"__getattr__", "__dir__", "__all__"})
    # Without it, `from std_msgs.msg import *` would import only the classes created so far.
    vars(module)["__all__"] = [name for name, type_name in types.items() if type_name not in UNSUPPORTED]
