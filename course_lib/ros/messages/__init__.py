"""ROS message types: their classes, their bytes, their plain values."""

from course_lib.ros.messages.message import RosMessage
from course_lib.ros.messages.registry import action_class, message_class, service_class, type_name
from course_lib.ros.messages.wire import compile_wire, deserialize, serialize, to_plain

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
