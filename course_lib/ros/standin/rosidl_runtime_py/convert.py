"""Conversions of messages to YAML, CSV and dictionaries."""

from collections import OrderedDict
from typing import Any

from course_lib.ros.messages.conversions import PrintOptions, to_csv, to_dict, to_yaml


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
    ordered: OrderedDict[str, Any] = _ordered(to_dict(msg, PrintOptions(truncate_length, no_arr, no_str)))
    return ordered


def get_message_slot_types(msg: Any) -> "OrderedDict[str, Any]":
    """Return the types of a message's fields by name, as objects of rosidl_parser."""
    return OrderedDict(zip(msg.get_fields_and_field_types(), msg.SLOT_TYPES, strict=True))


def _ordered(value: Any) -> Any:
    if isinstance(value, dict):
        return OrderedDict((name, _ordered(item)) for name, item in value.items())
    return [_ordered(item) for item in value] if isinstance(value, list) else value
