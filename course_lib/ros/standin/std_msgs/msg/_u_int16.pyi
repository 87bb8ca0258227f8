# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class UInt16(Message):
    data: int
    def __init__(
        self,
        *,
        data: int = ...,
        check_fields: bool = ...,
    ) -> None: ...
