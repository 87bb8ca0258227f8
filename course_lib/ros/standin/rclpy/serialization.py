"""Serialization of messages to CDR, the format of bags and of the wire."""

from typing import TypeVar

from course_lib.ros.messages import RosMessage, deserialize, serialize
from rclpy.impl.endpoint import NO_TYPE_SUPPORT

MsgT = TypeVar("MsgT", bound=RosMessage)


def serialize_message(message: RosMessage) -> bytes:
    """Serialize a message."""
    if not isinstance(message, RosMessage):
        raise AttributeError(NO_TYPE_SUPPORT.format("type"))
    return serialize(message)


def deserialize_message(serialized_message: bytes, message_type: type[MsgT]) -> MsgT:
    """Deserialize a message. Raise a CourseError if the bytes are not a message of this type."""
    if not (isinstance(message_type, type) and issubclass(message_type, RosMessage)):
        raise AttributeError(NO_TYPE_SUPPORT.format("type"))
    if not isinstance(serialized_message, bytes):
        raise TypeError("rclpy_deserialize(): incompatible function arguments.")
    return deserialize(serialized_message, message_type)
