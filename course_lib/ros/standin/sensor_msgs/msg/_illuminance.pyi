# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from std_msgs.msg._header import Header

class Illuminance(Message):
    header: Header
    illuminance: float
    variance: float
    def __init__(
        self,
        *,
        header: Header = ...,
        illuminance: float = ...,
        variance: float = ...,
        check_fields: bool = ...,
    ) -> None: ...
