# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._wrench import Wrench
from std_msgs.msg._header import Header

class WrenchStamped(Message):
    header: Header
    wrench: Wrench
    def __init__(
        self,
        *,
        header: Header = ...,
        wrench: Wrench = ...,
        check_fields: bool = ...,
    ) -> None: ...
