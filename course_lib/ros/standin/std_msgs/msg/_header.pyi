# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from builtin_interfaces.msg._time import Time
from course_lib.ros.messages.message import Message

class Header(Message):
    stamp: Time
    frame_id: str
    def __init__(
        self,
        *,
        stamp: Time = ...,
        frame_id: str = ...,
        check_fields: bool = ...,
    ) -> None: ...
