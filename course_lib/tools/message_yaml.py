"""Messages on the command line: found by type, filled from YAML, printed as YAML or CSV."""

import sys
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.messages import RosMessage, message_class, to_plain, type_name
from course_lib.ros.messages.definitions import PRIMITIVES, FieldDefinition, definition, type_names


def kind_of(find: Any, type_name: str, folder: str) -> Any:
    """Return the class of a message, service or action type; as in ROS its folder may be missing."""
    package, *rest = type_name.split("/")
    whole = "/".join([package, folder, *rest] if len(rest) == 1 else [package, *rest])
    try:
        return find(whole)
    except CourseError as error:
        if folder == "msg":  # the error has ROS's words already
            raise
        word, end = {"srv": ("service", "_Request"), "action": ("action", "_Goal")}[folder]
        there = [
            name.removesuffix(end) for name in type_names() if f"/{folder}/" in name and name.endswith(end)
        ]
        if whole in there:
            raise
        message = f"The passed {word} type is invalid: {whole}{did_you_mean(whole, there)}"
        raise CourseError(message) from error


def check_type(name: str, type_name: str, there: Mapping[str, Sequence[str]]) -> None:
    """Raise a CourseError if a name exists with another type: waiting for it would never end."""
    if name in there and type_name not in there[name]:
        raise CourseError(f"{name} has the type {', '.join(there[name])}, not {type_name}.")


SetTime = Callable[[RosMessage], None]  # takes a builtin_interfaces/msg/Time


def fill(message: RosMessage, text: str) -> list[SetTime]:
    """Set a message's fields from YAML like ``{header: auto, x: 1.0}``.

    Returns:
        What sets the times that were given as ``now``, or with a header as ``auto``.

    Raises:
        CourseError: No YAML, no dictionary, or a value that does not fit; with ROS's words.
    """
    import yaml  # type: ignore[import-untyped]  # PyYAML ships no types

    try:
        values = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise CourseError(f"{text!r} is not YAML: {error}. Write it like '{{x: 1.0, y: 2.0}}'.") from error
    if not isinstance(values, dict):
        raise CourseError(
            "The passed value needs to be a dictionary in YAML format, like '{x: 1.0}' or 'x: 1.0' "
            "with a space after the colon."
        )
    try:
        return set_fields(message, values)
    except (AttributeError, AssertionError, TypeError, ValueError, OverflowError) as error:
        fields = ", ".join(f"{name}: {of}" for name, of in message.get_fields_and_field_types().items())
        raise CourseError(
            f"Failed to populate field: {error}. {type_name(message)} has {fields or 'no field'}."
        ) from error


def set_fields(message: RosMessage, values: Any) -> list[SetTime]:
    """Set fields from dicts, lists and numbers; returns as `fill`, raises ROS's exceptions."""
    times: list[SetTime] = []
    _set(message, values, times)
    return times


def _set(message: RosMessage, values: Any, times: list[SetTime]) -> None:
    if not isinstance(values, dict):
        raise TypeError(f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}")
    items = {f.name: f.base for f in definition(type_name(message)).fields if f.is_message}
    for name, value in values.items():
        field = getattr(message, name)
        kind = type_name(field) if isinstance(field, RosMessage) else None
        if (kind, value) == ("std_msgs/msg/Header", "auto"):
            times.append(partial(setattr, field, "stamp"))
        elif (kind, value) == ("builtin_interfaces/msg/Time", "now"):
            times.append(partial(setattr, message, name))
        elif name in items:
            make = partial(_made, items[name], times=times)
            setattr(message, name, make(value) if kind else [make(one) for one in value])
        else:
            setattr(message, name, _converted(value, field))


def _made(type_of_it: str, values: Any, times: list[SetTime]) -> RosMessage:
    message = message_class(type_of_it)()
    _set(message, values, times)
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
    import yaml

    plain = _with_notes(message, to_plain(message, style.truncate), style)
    text: str = yaml.dump(
        plain, allow_unicode=True, width=sys.maxsize, default_flow_style=style.flow, sort_keys=False
    )
    return text


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
    for field in definition(type_name(message)).fields:
        if field.name in message.get_fields_and_field_types():
            yield field, getattr(message, field.name)


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
