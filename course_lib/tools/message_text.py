"""Messages as `ros2 topic echo` prints them (rosidl_runtime_py.convert)."""

import sys
from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from course_lib.ros.messages import Message, to_plain, type_name
from course_lib.ros.messages.definitions import PRIMITIVES, FieldDefinition, definition


@dataclass(frozen=True)
class Style:
    """What to leave out: the rest of long values, all arrays, all strings."""

    truncate: int | None = 128  # elements of a sequence, characters of a string
    no_arrays: bool = False
    no_strings: bool = False
    flow: bool = False  # one line of YAML instead of a block


def to_yaml(message: Message, style: Style) -> str:
    """Write a message as YAML, its last line ended."""
    import yaml  # type: ignore[import-untyped]  # PyYAML ships no types

    plain = _with_notes(message, to_plain(message, style.truncate), style)
    text: str = yaml.dump(
        plain, allow_unicode=True, width=sys.maxsize, default_flow_style=style.flow, sort_keys=False
    )
    return text


def to_csv(value: Any, style: Style) -> str:
    """Write a message's values in a row, with a comma between them."""
    if isinstance(value, Message):
        items = _items(value)
        return _joined([_array_note(item, field, style) or to_csv(item, style) for field, item in items])
    if isinstance(value, list | tuple | array | np.ndarray):
        long = style.truncate is not None and len(value) > style.truncate
        return _joined([*(to_csv(item, style) for item in value[: style.truncate]), *["..."] * long])
    if isinstance(value, str):
        return _string_note(value) if style.no_strings else str(to_plain(value, style.truncate))
    return str(value)


def _joined(parts: list[str]) -> str:
    """Join with commas; as in ROS there is none after empty values at the beginning."""
    text = ""
    for part in parts:
        text += f",{part}" if text else part
    return text


def _with_notes(value: Any, plain: Any, style: Style) -> Any:
    """Put notes where arrays or strings are not wanted, in the plain form of a message."""
    if isinstance(value, Message):
        for field, item in _items(value):
            note = _array_note(item, field, style)
            plain[field.name] = note or _with_notes(item, plain[field.name], style)
    elif isinstance(value, list) and style.no_strings:
        shown = value[: style.truncate]
        plain[: len(shown)] = [_with_notes(*pair, style) for pair in zip(shown, plain, strict=False)]
    elif isinstance(value, str) and style.no_strings:
        return _string_note(value)
    return plain


def _items(message: Message) -> Iterator[tuple[FieldDefinition, Any]]:
    for field in definition(type_name(message)).fields:
        if field.name in message.get_fields_and_field_types():
            yield field, getattr(message, field.name)


def _string_note(value: str) -> str:
    return f"<string length: <{len(value)}>>"


def _array_note(value: Any, field: FieldDefinition, style: Style) -> str:
    """Give what stands for an array that is not wanted, or ""."""
    if field.container == "scalar" or not style.no_arrays:
        return ""
    base = field.base if field.is_message else PRIMITIVES[field.base].ros_name
    if field.container == "array":
        return f"<array type: {base}[{field.size}]>"
    bound = f"[{field.size}]" if field.size else ""
    return f"<sequence type: {base}{bound}, length: {len(value)}>"
