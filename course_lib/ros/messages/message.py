"""The base of all message classes, and their creation from definitions."""

from array import array
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from inspect import Parameter, Signature
from operator import attrgetter
from typing import Any, ClassVar, Self

import numpy as np

from course_lib.ros.messages.compiled import CHECKED, constructor
from course_lib.ros.messages.definitions import PRIMITIVES, FieldDefinition, MessageDefinition
from course_lib.ros.messages.interface_files import PLACEHOLDER
from course_lib.ros.messages.kinds import Kind, kind_of
from course_lib.ros.mistakes import Mistake, marked

_ATOMS = {bool, int, float, str, bytes}


class RosMessage:
    """A ROS message; its class knows the kind of each field, its slots hold the values.

    Without `check_fields` assignments are not checked: Jazzy's own default, which aborts on publishing, and
    the kit's where ROS_PYTHON_CHECK_FIELDS is 0. A value without a name is a TypeError as in Python; an
    unknown field, or a value that does not fit, is an AssertionError with ROS's text.
    """

    __slots__ = ()
    _TYPE_NAME: ClassVar[str]  # "visualization_msgs/msg/Marker"
    _KINDS: ClassVar[Mapping[str, Kind]]
    _SLOTS: ClassVar[Sequence[str]]
    _fields_and_field_types: ClassVar[Mapping[str, str]]
    _check_fields: bool

    def __init__(self, *positional: Any, check_fields: bool = CHECKED, **values: Any) -> None:
        if positional:
            given = f"takes 1 positional argument but {1 + len(positional)} were given"
            error = TypeError(f"{type(self).__name__}.__init__() {given}")
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
        package, folder, name = self._TYPE_NAME.split("/")
        fields = ", ".join(f"{field}={_field_repr(getattr(self, field))}" for field in self._KINDS)
        return f"{package}.{folder}.{name}({fields})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, self.__class__):
            return False
        return all(_equal(getattr(self, name), getattr(other, name)) for name in self._KINDS)

    def __deepcopy__(self, memo: dict[int, Any]) -> Self:
        """Copy the slots themselves; Python's general way, by pickling, takes several times as long."""
        made = self.__class__.__new__(self.__class__)
        memo[id(self)] = made
        for slot in self._SLOTS:
            value = getattr(self, slot)
            setattr(made, slot, value if type(value) in _ATOMS else deepcopy(value, memo))
        if hasattr(self, "__dict__"):  # of a subclass
            vars(made).update(deepcopy(vars(self), memo))
        return made

    __hash__ = None  # type: ignore[assignment]  # as in ROS: messages are mutable

    @classmethod
    def get_fields_and_field_types(cls) -> dict[str, str]:
        """Return each field's type in ROS's words, ``sequence<geometry_msgs/Point>`` and the like."""
        return dict(cls._fields_and_field_types)


def make_class(definition: MessageDefinition, message_class: Callable[[str], type]) -> type[RosMessage]:
    """Create the class of a message type; `message_class` returns the classes of its sub messages."""
    name = definition.type_name.rsplit("/", 1)[1]
    fields = [field for field in definition.fields if field.name != PLACEHOLDER]
    slots = [*("_" + field.name for field in fields), "_check_fields"]
    kinds = {field.name: kind_of(field, message_class) for field in fields}
    defaults = {f"{f.name.upper()}__DEFAULT": f.default for f in fields if f.default is not None}
    namespace = {
        "__doc__": _docstring(definition),
        "__signature__": Signature([Parameter(name, Parameter.KEYWORD_ONLY, default=...) for name in kinds]),
        "__module__": home_of(definition.type_name),
        "__slots__": slots,
        "_TYPE_NAME": definition.type_name,
        "_KINDS": kinds,
        "_SLOTS": slots,
        "__init__": constructor(kinds, RosMessage.__init__),
        "_fields_and_field_types": {field.name: ros_type(field) for field in fields},
    }
    accessors = {name: _accessor(name, kind) for name, kind in kinds.items()}
    return type(name, (RosMessage,), {**namespace, **definition.constants, **defaults, **accessors})


def home_of(type_name: str) -> str:
    """Name the module that rosidl makes for a type, ``std_msgs.msg._u_int8_multi_array`` and the like."""
    from re import sub

    package, folder, name = type_name.split("/")
    whole = name.split("_")[0]  # the parts of a service or an action share one
    snake_case = sub("([a-z0-9])([A-Z])", r"\1_\2", sub("(.)([A-Z][a-z]+)", r"\1_\2", whole)).lower()
    return f"{package}.{folder}._{snake_case}"


def ros_type(field: FieldDefinition) -> str:
    """Name a field's type as get_fields_and_field_types() does."""
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


def _docstring(definition: MessageDefinition) -> str:
    name = definition.type_name.rsplit("/", 1)[1]
    constants = "".join(f"\n  {constant}" for constant in definition.constants)
    return f"Message class '{name}'." + (f"\n\nConstants:{constants}\n" if constants else "")


def _accessor(name: str, kind: Kind) -> property:
    slot, check, keep, exact = "_" + name, kind.check, kind.keep, kind.exact

    def assign(self: RosMessage, value: Any) -> None:
        if self._check_fields and type(value) is not exact:
            check(value)
        setattr(self, slot, value if keep is None else keep(value))

    return property(attrgetter(slot), assign, doc=f"Message field '{name}'.")


def _field_repr(value: Any) -> str:
    return repr(value.tolist()) if isinstance(value, array) else repr(value)


def _equal(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other)
    return bool(one == other)
