"""Setting message fields from dictionaries."""

from collections.abc import Callable
from typing import Any

from course_lib.ros.messages.conversions import set_fields


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
