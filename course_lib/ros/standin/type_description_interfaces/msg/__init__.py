"""The message types of type_description_interfaces."""

from course_lib.ros.messages.registry import import_messages as _import_messages

globals().update(_import_messages(__name__))
