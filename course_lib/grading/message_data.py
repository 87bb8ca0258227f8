"""Messages of a check file, which are plain data, as ROS messages."""

import re
from collections.abc import Mapping
from typing import Any

from course_lib.errors import CourseError
from course_lib.grading.task import Message, resolve


def build(message: Message, personal: Mapping[str, Any]) -> Any:
    """Make the ROS message, with the student's own values in it.

    Raises:
        CourseError: A field is unknown or its value does not fit; names topic and reason.
    """
    from course_lib.ros.messages import message_class

    try:
        return _filled(message_class(message.type_name), resolve(message.fields, personal))
    except (AssertionError, TypeError) as error:  # what ROS raises for a wrong field or value
        raise CourseError(f"the message for {message.topic} ({message.type_name}): {error}") from error


def _filled(cls: Any, fields: Mapping[str, Any]) -> Any:
    types = cls.get_fields_and_field_types()
    return cls(**{name: _value(types.get(name, ""), value) for name, value in fields.items()})


def _value(ros_type: str, value: Any) -> Any:
    """A field's value: dicts become the messages that its type names, `sequence<geometry_msgs/Point>`."""
    from course_lib.ros.messages import message_class

    named = re.search(r"(\w+)/(\w+)", ros_type)
    if ros_type in ("float", "double") and isinstance(value, int):
        return float(value)
    if named is None:
        return list(value) if isinstance(value, tuple) else value
    cls = message_class(f"{named[1]}/msg/{named[2]}")
    return [_filled(cls, item) for item in value] if isinstance(value, (list, tuple)) else _filled(cls, value)
