"""Messages as bytes, as they travel and as bags hold them."""

from typing import TypeVar

from course_lib.ros.messages import Message, deserialize, serialize

MsgT = TypeVar("MsgT", bound=Message)


def serialize_message(message: Message) -> bytes:
    """Return a message as bytes (CDR)."""
    return serialize(message)


def deserialize_message(serialized_message: bytes, message_type: type[MsgT]) -> MsgT:
    """Make a message from bytes (CDR)."""
    return deserialize(serialized_message, message_type)
