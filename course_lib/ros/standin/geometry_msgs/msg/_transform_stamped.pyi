# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._transform import Transform
from std_msgs.msg._header import Header

class TransformStamped(Message):
    header: Header
    child_frame_id: str
    transform: Transform
    def __init__(
        self,
        *,
        header: Header = ...,
        child_frame_id: str = ...,
        transform: Transform = ...,
        check_fields: bool = ...,
    ) -> None: ...
