"""Conversions of messages to YAML, CSV and dictionaries, and back from dictionaries."""

from collections import OrderedDict
from collections.abc import Callable
from typing import Any

from course_lib.ros.messages.conversions import PrintOptions, set_fields, to_csv, to_dict, to_yaml


def message_to_yaml(
    msg: Any,
    *,
    truncate_length: int | None = None,
    no_arr: bool = False,
    no_str: bool = False,
    flow_style: bool = False,
) -> str:
    """Convert a message to YAML, in block or flow style. Long values can be truncated."""
    return to_yaml(msg, PrintOptions(truncate_length, no_arr, no_str, flow_style))


def message_to_csv(
    msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> str:
    """Convert a message's values to comma-separated text."""
    return to_csv(msg, PrintOptions(truncate_length, no_arr, no_str))


def message_to_ordereddict(
    msg: Any, *, truncate_length: int | None = None, no_arr: bool = False, no_str: bool = False
) -> "OrderedDict[str, Any]":
    """Convert a message to nested dictionaries in the order of its fields."""
    ordered: OrderedDict[str, Any] = _to_ordered(to_dict(msg, PrintOptions(truncate_length, no_arr, no_str)))
    return ordered


def get_message_slot_types(msg: Any) -> "OrderedDict[str, Any]":
    """Return the types of a message's fields by name, as objects of rosidl_parser."""
    return OrderedDict(zip(msg.get_fields_and_field_types(), msg.SLOT_TYPES, strict=True))


def _to_ordered(value: Any) -> Any:
    if isinstance(value, dict):
        return OrderedDict((name, _to_ordered(item)) for name, item in value.items())
    return [_to_ordered(item) for item in value] if isinstance(value, list) else value


def set_message_fields(
    msg: Any,
    values: dict[str, Any],
    expand_header_auto: bool = False,
    expand_time_now: bool = False,
) -> list[Callable[[Any], None]]:
    """Set fields by name.

    Raises AttributeError for an unknown field and TypeError for a wrong value.

    Returns:
        Functions that set the headers given as "auto" and the times given as "now".
    """
    return set_fields(msg, values, header_auto=expand_header_auto, time_now=expand_time_now)
