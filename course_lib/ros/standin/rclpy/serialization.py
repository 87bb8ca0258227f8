"""Serialization of messages to CDR, the format of bags and of the wire."""

from typing import TypeVar

from course_lib.ros.messages import RosMessage, deserialize, serialize
from rclpy.impl.endpoint import require_type

MsgT = TypeVar("MsgT", bound=RosMessage)


def serialize_message(message: RosMessage) -> bytes:
    """Serialize a message."""
    require_type(type(message), "message")
    return serialize(message)


def deserialize_message(serialized_message: bytes, message_type: type[MsgT] | MsgT) -> MsgT:
    """Deserialize a message of a class, which may be given by one of its messages, as in rclpy.

    Raises:
        CourseError: The bytes are not a message of this type.
    """
    message_class: type[MsgT] = require_type(message_type, "message")
    if not isinstance(serialized_message, bytes):
        raise TypeError("rclpy_deserialize(): incompatible function arguments.")
    return deserialize(serialized_message, message_class)
