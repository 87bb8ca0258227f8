# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._quaternion import Quaternion
from std_msgs.msg._header import Header

class QuaternionStamped(Message):
    header: Header
    quaternion: Quaternion
    def __init__(
        self,
        *,
        header: Header = ...,
        quaternion: Quaternion = ...,
        check_fields: bool = ...,
    ) -> None: ...
