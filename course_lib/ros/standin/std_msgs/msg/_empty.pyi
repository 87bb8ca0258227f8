# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class Empty(Message):
    def __init__(
        self,
        *,
        check_fields: bool = ...,
    ) -> None: ...
