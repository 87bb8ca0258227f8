# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from builtin_interfaces.msg._time import Time
from course_lib.ros.messages.message import Message
from std_msgs.msg._header import Header

class TimeReference(Message):
    header: Header
    time_ref: Time
    source: str
    def __init__(
        self,
        *,
        header: Header = ...,
        time_ref: Time = ...,
        source: str = ...,
        check_fields: bool = ...,
    ) -> None: ...
