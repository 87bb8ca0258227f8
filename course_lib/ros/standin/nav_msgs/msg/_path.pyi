# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._pose_stamped import PoseStamped
from std_msgs.msg._header import Header

class Path(Message):
    header: Header
    poses: list[PoseStamped]
    def __init__(
        self,
        *,
        header: Header = ...,
        poses: list[PoseStamped] = ...,
        check_fields: bool = ...,
    ) -> None: ...
