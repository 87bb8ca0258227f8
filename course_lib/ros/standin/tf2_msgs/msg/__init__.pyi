# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message
import geometry_msgs.msg

class TF2Error(Message):
    NO_ERROR: Final = 0
    LOOKUP_ERROR: Final = 1
    CONNECTIVITY_ERROR: Final = 2
    EXTRAPOLATION_ERROR: Final = 3
    INVALID_ARGUMENT_ERROR: Final = 4
    TIMEOUT_ERROR: Final = 5
    TRANSFORM_ERROR: Final = 6
    error: int
    error_string: str
    def __init__(self, *, error: int = ..., error_string: str = ..., check_fields: bool = ...) -> None: ...

class TFMessage(Message):
    transforms: list[geometry_msgs.msg.TransformStamped]
    def __init__(
        self,
        *,
        transforms: list[geometry_msgs.msg.TransformStamped] = ...,
        check_fields: bool = ...,
    ) -> None: ...
