"""Messages from dicts and lists, and as YAML or CSV, as rosidl_runtime_py has them."""

import sys
from array import array
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from course_lib.ros.messages.definitions import PRIMITIVES, FieldDefinition, definition
from course_lib.ros.messages.message import RosMessage
from course_lib.ros.messages.registry import message_class, type_name
from course_lib.ros.messages.wire import to_plain

SetTime = Callable[[RosMessage], None]  # takes a builtin_interfaces/msg/Time


@dataclass
class _Clock:
    """The words that stand for the time of publishing, and what sets the times given by them."""

    header_auto: bool
    time_now: bool
    setters: list[SetTime] = field(default_factory=list)


def set_fields(
    message: RosMessage, values: Any, *, header_auto: bool = True, time_now: bool = True
) -> list[SetTime]:
    """Set fields from dicts, lists and numbers; raises ROS's exceptions.

    Args:
        message: What is filled.
        values: The fields by name.
        header_auto: Whether a header may be "auto".
        time_now: Whether a time may be "now".

    Returns:
        What sets the times that were given as "now", or with a header as "auto".
    """
    clock = _Clock(header_auto, time_now)
    _set(message, values, clock)
    return clock.setters


def _set(message: RosMessage, values: Any, clock: _Clock) -> None:
    if not isinstance(values, dict):
        raise TypeError(f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}")
    items = {f.name: f.base for f in definition(type_name(message)).fields if f.is_message}
    for name, value in values.items():
        present = getattr(message, name)
        kind = type_name(present) if isinstance(present, RosMessage) else None
        if (kind, value) == ("std_msgs/msg/Header", "auto") and clock.header_auto:
            clock.setters.append(partial(setattr, present, "stamp"))
        elif (kind, value) == ("builtin_interfaces/msg/Time", "now") and clock.time_now:
            clock.setters.append(partial(setattr, message, name))
        elif name in items:
            make = partial(_made, items[name], clock=clock)
            setattr(message, name, make(value) if kind else [make(one) for one in value])
        else:
            setattr(message, name, _converted(value, present))


def _made(type_of_it: str, values: Any, clock: _Clock) -> RosMessage:
    if isinstance(values, RosMessage) and type_name(values) == type_of_it:
        return values
    message = message_class(type_of_it)()
    _set(message, values, clock)
    return message


def _converted(value: Any, field: Any) -> Any:
    """Convert a YAML value to the type of the field's present value, as ROS does."""
    if isinstance(field, array):
        return array(field.typecode, value)
    if isinstance(field, np.ndarray):
        return np.array(value, dtype=field.dtype)
    if isinstance(field, bytes) and isinstance(value, int):
        return bytes([value])
    return value if type(value) is type(field) else type(field)(value)


@dataclass(frozen=True)
class Style:
    """Omissions in printed messages: the rest of long values, arrays, strings."""

    truncate: int | None = 128  # elements of a sequence, characters of a string
    no_arrays: bool = False
    no_strings: bool = False
    flow: bool = False  # one line of YAML instead of a block


def to_yaml(message: RosMessage, style: Style) -> str:
    """Return a message as YAML, its last line ended."""
    import yaml  # type: ignore[import-untyped]  # PyYAML ships no types

    text: str = yaml.dump(
        to_dict(message, style),
        allow_unicode=True,
        width=sys.maxsize,
        default_flow_style=style.flow,
        sort_keys=False,
    )
    return text


def to_dict(message: RosMessage, style: Style) -> dict[str, Any]:
    """Return a message as dicts, lists, strings and numbers, in the order of the fields."""
    plain: dict[str, Any] = _with_notes(message, to_plain(message, style.truncate), style)
    return plain


def to_csv(value: Any, style: Style) -> str:
    """Return a message's values in a row, separated by commas."""
    if isinstance(value, RosMessage):
        items = _items(value)
        return _joined([_array_note(item, field, style) or to_csv(item, style) for field, item in items])
    if isinstance(value, list | tuple | array | np.ndarray):
        long = style.truncate is not None and len(value) > style.truncate
        return _joined([*(to_csv(item, style) for item in value[: style.truncate]), *["..."] * long])
    if isinstance(value, str):
        return _string_note(value) if style.no_strings else str(to_plain(value, style.truncate))
    return str(value)


def _joined(parts: list[str]) -> str:
    """Join with commas; as in ROS none follows empty values at the beginning."""
    text = ""
    for part in parts:
        text += f",{part}" if text else part
    return text


def _with_notes(value: Any, plain: Any, style: Style) -> Any:
    """Replace omitted arrays and strings by notes in the plain form of a message."""
    if isinstance(value, RosMessage):
        for field, item in _items(value):
            note = _array_note(item, field, style)
            plain[field.name] = note or _with_notes(item, plain[field.name], style)
    elif isinstance(value, list) and style.no_strings:
        shown = value[: style.truncate]
        plain[: len(shown)] = [_with_notes(*pair, style) for pair in zip(shown, plain, strict=False)]
    elif isinstance(value, str) and style.no_strings:
        return _string_note(value)
    return plain


def _items(message: RosMessage) -> Iterator[tuple[FieldDefinition, Any]]:
    for item in definition(type_name(message)).fields:
        if item.name in message.get_fields_and_field_types():
            yield item, getattr(message, item.name)


def _string_note(value: str) -> str:
    return f"<string length: <{len(value)}>>"


def _array_note(value: Any, field: FieldDefinition, style: Style) -> str:
    """Return the note in place of an omitted array, or ""."""
    if field.container == "scalar" or not style.no_arrays:
        return ""
    base = field.base if field.is_message else PRIMITIVES[field.base].ros_name
    if field.container == "array":
        return f"<array type: {base}[{field.size}]>"
    bound = f"[{field.size}]" if field.size else ""
    return f"<sequence type: {base}{bound}, length: {len(value)}>"
