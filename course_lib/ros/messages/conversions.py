"""Conversions of messages from dicts and lists, and to YAML and CSV, as in rosidl_runtime_py."""

import sys
from array import array
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from course_lib.ros.messages.cdr import to_plain
from course_lib.ros.messages.definitions import PRIMITIVES, FieldDefinition, definition
from course_lib.ros.messages.message import RosMessage, message_class, type_name

# Accepts a builtin_interfaces/msg/Time.
SetTime = Callable[[RosMessage], None]
# The note that replaces an omitted string, with its length.
_STRING_NOTE = "<string length: <{}>>"


@dataclass
class _PublishTimes:
    """Whether "auto" and "now" are the time of publishing, and functions that set these times."""

    expand_header_auto: bool
    expand_time_now: bool
    setters: list[SetTime] = field(default_factory=list)


def set_fields(
    message: RosMessage, values: Any, *, expand_header_auto: bool = True, expand_time_now: bool = True
) -> list[SetTime]:
    """Set fields from dicts, lists and numbers. Raise ROS's exceptions.

    Args:
        message: The message to fill.
        values: The fields by name.
        expand_header_auto: Whether a header may be "auto".
        expand_time_now: Whether a time may be "now".

    Returns:
        Functions that set the times given as "now", or with a header as "auto".
    """
    publish_times = _PublishTimes(expand_header_auto, expand_time_now)
    _set(message, values, publish_times)
    return publish_times.setters


def _set(message: RosMessage, values: Any, publish_times: _PublishTimes) -> None:
    if not isinstance(values, dict):
        raise TypeError(f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}")
    items = {f.name: f.base for f in definition(type_name(message)).fields if f.is_message}
    for name, value in values.items():
        present = getattr(message, name)
        kind = type_name(present) if isinstance(present, RosMessage) else None
        if (kind, value) == ("std_msgs/msg/Header", "auto") and publish_times.expand_header_auto:
            publish_times.setters.append(partial(setattr, present, "stamp"))
        elif (kind, value) == ("builtin_interfaces/msg/Time", "now") and publish_times.expand_time_now:
            publish_times.setters.append(partial(setattr, message, name))
        elif name in items:
            messages = []
            for item in [value] if kind else value:
                inner = item
                if not isinstance(item, RosMessage) or type_name(item) != items[name]:
                    inner = message_class(items[name])()
                    _set(inner, item, publish_times)
                messages.append(inner)
            setattr(message, name, messages[0] if kind else messages)
        # As in ROS, a YAML value is converted to the type of the field's current value.
        elif isinstance(present, array):
            setattr(message, name, array(present.typecode, value))
        elif isinstance(present, np.ndarray):
            setattr(message, name, np.array(value, dtype=present.dtype))
        elif isinstance(present, bytes) and isinstance(value, int):
            setattr(message, name, bytes([value]))
        else:
            setattr(message, name, value if type(value) is type(present) else type(present)(value))


@dataclass(frozen=True)
class PrintOptions:
    """The parts omitted from printed messages: the rest of long values, arrays, strings."""

    # Limit on the elements of a sequence and the characters of a string.
    truncate: int | None = 128
    no_arrays: bool = False
    no_strings: bool = False
    # Whether YAML has each sequence on one line.
    flow: bool = False


def to_yaml(message: RosMessage, style: PrintOptions) -> str:
    """Convert a message to YAML, which ends with a newline."""
    import yaml

    class BlockMappings(yaml.Dumper):  # type: ignore[misc]  # yaml has no types
        def represent_mapping(self, tag: str, mapping: Any, flow_style: bool | None = None) -> Any:
            """Write a message in block style even with `flow`, which applies to sequences only."""
            return super().represent_mapping(tag, mapping, flow_style=False)

    text: str = yaml.dump(
        to_dict(message, style),
        Dumper=BlockMappings,
        allow_unicode=True,
        width=sys.maxsize,
        default_flow_style=style.flow,
        sort_keys=False,
    )
    return text


def to_dict(message: RosMessage, style: PrintOptions) -> dict[str, Any]:
    """Convert a message to dicts, lists, strings and numbers, in the order of the fields."""
    plain: dict[str, Any] = _insert_notes(message, to_plain(message, style.truncate), style)
    return plain


def to_csv(value: Any, style: PrintOptions) -> str:
    """Convert a message's values to one line, separated by commas."""
    if isinstance(value, RosMessage):
        items = _items(value)
        cells = [_array_note(item, field, style) or to_csv(item, style) for field, item in items]
        return _join_values(cells)
    if isinstance(value, list | tuple | array | np.ndarray):
        long = style.truncate is not None and len(value) > style.truncate
        return _join_values([*(to_csv(item, style) for item in value[: style.truncate]), *["..."] * long])
    if isinstance(value, str):
        return _STRING_NOTE.format(len(value)) if style.no_strings else str(to_plain(value, style.truncate))
    return str(value)


def _join_values(parts: list[str]) -> str:
    """Join with commas. As in ROS, no comma follows empty values at the beginning."""
    text = ""
    for part in parts:
        text += f",{part}" if text else part
    return text


def _insert_notes(value: Any, plain: Any, style: PrintOptions) -> Any:
    """Replace omitted arrays and strings by notes, in the plain form of a message."""
    if isinstance(value, RosMessage):
        for field, item in _items(value):
            note = _array_note(item, field, style)
            plain[field.name] = note or _insert_notes(item, plain[field.name], style)
    elif isinstance(value, list) and style.no_strings:
        visible_items = value[: style.truncate]
        plain[: len(visible_items)] = [
            _insert_notes(*pair, style) for pair in zip(visible_items, plain, strict=False)
        ]
    elif isinstance(value, str) and style.no_strings:
        return _STRING_NOTE.format(len(value))
    return plain


def _items(message: RosMessage) -> Iterator[tuple[FieldDefinition, Any]]:
    for item in definition(type_name(message)).fields:
        if item.name in message.get_fields_and_field_types():
            yield item, getattr(message, item.name)


def _array_note(value: Any, field: FieldDefinition, style: PrintOptions) -> str:
    """Return the note that replaces an omitted array, or ""."""
    if field.container == "scalar" or not style.no_arrays:
        return ""
    base = field.base if field.is_message else PRIMITIVES[field.base].ros_name
    if field.container == "array":
        return f"<array type: {base}[{field.size}]>"
    bound_text = f"[{field.size}]" if field.size else ""
    return f"<sequence type: {base}{bound_text}, length: {len(value)}>"
