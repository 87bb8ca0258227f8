"""Messages as bytes (CDR), as they travel and as bags hold them."""

from course_lib.ros.messages import deserialize as deserialize_message
from course_lib.ros.messages import serialize as serialize_message

__all__ = ["deserialize_message", "serialize_message"]
