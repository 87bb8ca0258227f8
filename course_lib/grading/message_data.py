"""Messages of a check file, which are plain data, as ROS messages."""

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
    from course_lib.tools.message_yaml import set_fields

    made = message_class(message.type_name)()
    try:
        set_fields(made, resolve(message.fields, personal))
    except (AssertionError, AttributeError, TypeError, ValueError) as error:  # what ROS raises for a misfit
        raise CourseError(f"the message for {message.topic} ({message.type_name}): {error}") from error
    return made
