"""ROS message types: their classes, their serialization and their plain values."""

from course_lib.ros.messages.cdr import compile_wire, deserialize, serialize, to_plain
from course_lib.ros.messages.message import RosMessage, action_class, message_class, service_class, type_name

__all__ = [
    "RosMessage",
    "action_class",
    "compile_wire",
    "deserialize",
    "message_class",
    "serialize",
    "service_class",
    "to_plain",
    "type_name",
]
