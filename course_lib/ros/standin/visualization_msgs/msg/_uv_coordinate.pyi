# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class UVCoordinate(Message):
    u: float
    v: float
    def __init__(
        self,
        *,
        u: float = ...,
        v: float = ...,
        check_fields: bool = ...,
    ) -> None: ...
