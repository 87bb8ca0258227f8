"""The types of message fields."""

from course_lib.ros.messages.idl import *  # noqa: F403
