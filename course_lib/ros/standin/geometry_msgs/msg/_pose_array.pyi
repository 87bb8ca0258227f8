# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._pose import Pose
from std_msgs.msg._header import Header

class PoseArray(Message):
    header: Header
    poses: list[Pose]
    def __init__(
        self,
        *,
        header: Header = ...,
        poses: list[Pose] = ...,
        check_fields: bool = ...,
    ) -> None: ...
