# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class Bool(Message):
    data: bool
    def __init__(
        self,
        *,
        data: bool = ...,
        check_fields: bool = ...,
    ) -> None: ...
