# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message
from std_msgs.msg._header import Header

class Range(Message):
    ULTRASOUND: Final = 0
    INFRARED: Final = 1
    header: Header
    radiation_type: int
    field_of_view: float
    min_range: float
    max_range: float
    range: float
    variance: float
    def __init__(
        self,
        *,
        header: Header = ...,
        radiation_type: int = ...,
        field_of_view: float = ...,
        min_range: float = ...,
        max_range: float = ...,
        range: float = ...,
        variance: float = ...,
        check_fields: bool = ...,
    ) -> None: ...
