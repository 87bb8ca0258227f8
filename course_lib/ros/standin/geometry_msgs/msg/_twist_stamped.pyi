# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._twist import Twist
from std_msgs.msg._header import Header

class TwistStamped(Message):
    header: Header
    twist: Twist
    def __init__(
        self,
        *,
        header: Header = ...,
        twist: Twist = ...,
        check_fields: bool = ...,
    ) -> None: ...
