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


def deserialize_message(serialized_message: bytes, message_type: type[MsgT] | MsgT) -> MsgT:
    """Deserialize a message, of a class or, as in rclpy, of the class of a given message.

    Raises:
        CourseError: The bytes are not a message of this type.
    """
    if isinstance(message_type, RosMessage):
        message_type = type(message_type)
    if not (isinstance(message_type, type) and issubclass(message_type, RosMessage)):
        raise AttributeError(NO_TYPE_SUPPORT.format(type(message_type).__name__))
    if not isinstance(serialized_message, bytes):
        raise TypeError("rclpy_deserialize(): incompatible function arguments.")
    return deserialize(serialized_message, message_type)
