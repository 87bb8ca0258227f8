# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class Byte(Message):
    data: bytes
    def __init__(
        self,
        *,
        data: bytes = ...,
        check_fields: bool = ...,
    ) -> None: ...
