"""Fills messages from YAML, as `ros2 topic pub` does (rosidl_runtime_py.set_message)."""

from array import array
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from course_lib.errors import CourseError
from course_lib.ros.messages import Message, message_class, type_name
from course_lib.ros.messages.definitions import definition

SetTime = Callable[[Message], None]  # takes a builtin_interfaces/msg/Time


def fill(message: Message, text: str) -> list[SetTime]:
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
        raise CourseError(f"{text!r} is no YAML: {error}. Write it like '{{x: 1.0, y: 2.0}}'.") from error
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


def set_fields(message: Message, values: Any) -> list[SetTime]:
    """Set fields from dicts, lists and numbers; returns as `fill`, raises what ROS raises for a misfit."""
    times: list[SetTime] = []
    _set(message, values, times)
    return times


def _set(message: Message, values: Any, times: list[SetTime]) -> None:
    if not isinstance(values, dict):
        raise TypeError(f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}")
    items = {f.name: f.base for f in definition(type_name(message)).fields if f.is_message}
    for name, value in values.items():
        field = getattr(message, name)
        kind = type_name(field) if isinstance(field, Message) else None
        if (kind, value) == ("std_msgs/msg/Header", "auto"):
            times.append(partial(setattr, field, "stamp"))
        elif (kind, value) == ("builtin_interfaces/msg/Time", "now"):
            times.append(partial(setattr, message, name))
        elif name in items:
            make = partial(_made, items[name], times=times)
            setattr(message, name, make(value) if kind else [make(one) for one in value])
        else:
            setattr(message, name, _converted(value, field))


def _made(type_of_it: str, values: Any, times: list[SetTime]) -> Message:
    message = message_class(type_of_it)()
    _set(message, values, times)
    return message


def _converted(value: Any, field: Any) -> Any:
    """Make of a YAML value what a field holds: as in ROS, with the type of what it holds now."""
    if isinstance(field, array):
        return array(field.typecode, value)
    if isinstance(field, np.ndarray):
        return np.array(value, dtype=field.dtype)
    if isinstance(field, bytes) and isinstance(value, int):
        return bytes([value])
    return value if type(value) is type(field) else type(field)(value)
