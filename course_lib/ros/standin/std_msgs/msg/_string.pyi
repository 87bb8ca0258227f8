# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class String(Message):
    data: str
    def __init__(
        self,
        *,
        data: str = ...,
        check_fields: bool = ...,
    ) -> None: ...
