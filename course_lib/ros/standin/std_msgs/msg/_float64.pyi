# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class Float64(Message):
    data: float
    def __init__(
        self,
        *,
        data: float = ...,
        check_fields: bool = ...,
    ) -> None: ...
