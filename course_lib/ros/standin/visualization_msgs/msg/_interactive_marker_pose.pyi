# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._pose import Pose
from std_msgs.msg._header import Header

class InteractiveMarkerPose(Message):
    header: Header
    pose: Pose
    name: str
    def __init__(
        self,
        *,
        header: Header = ...,
        pose: Pose = ...,
        name: str = ...,
        check_fields: bool = ...,
    ) -> None: ...
