# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class Pose2D(Message):
    x: float
    y: float
    theta: float
    def __init__(
        self,
        *,
        x: float = ...,
        y: float = ...,
        theta: float = ...,
        check_fields: bool = ...,
    ) -> None: ...
