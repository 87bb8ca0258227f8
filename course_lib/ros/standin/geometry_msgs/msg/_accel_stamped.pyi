# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._accel import Accel
from std_msgs.msg._header import Header

class AccelStamped(Message):
    header: Header
    accel: Accel
    def __init__(
        self,
        *,
        header: Header = ...,
        accel: Accel = ...,
        check_fields: bool = ...,
    ) -> None: ...
