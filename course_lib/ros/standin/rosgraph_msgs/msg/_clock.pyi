# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from builtin_interfaces.msg._time import Time
from course_lib.ros.messages.message import Message

class Clock(Message):
    clock: Time
    def __init__(
        self,
        *,
        clock: Time = ...,
        check_fields: bool = ...,
    ) -> None: ...
