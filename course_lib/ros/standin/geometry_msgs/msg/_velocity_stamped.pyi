# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._twist import Twist
from std_msgs.msg._header import Header

class VelocityStamped(Message):
    header: Header
    body_frame_id: str
    reference_frame_id: str
    velocity: Twist
    def __init__(
        self,
        *,
        header: Header = ...,
        body_frame_id: str = ...,
        reference_frame_id: str = ...,
        velocity: Twist = ...,
        check_fields: bool = ...,
    ) -> None: ...
