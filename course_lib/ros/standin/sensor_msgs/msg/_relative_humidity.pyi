# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from std_msgs.msg._header import Header

class RelativeHumidity(Message):
    header: Header
    relative_humidity: float
    variance: float
    def __init__(
        self,
        *,
        header: Header = ...,
        relative_humidity: float = ...,
        variance: float = ...,
        check_fields: bool = ...,
    ) -> None: ...
