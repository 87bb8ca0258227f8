# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._point import Point
from geometry_msgs.msg._quaternion import Quaternion

class Pose(Message):
    position: Point
    orientation: Quaternion
    def __init__(
        self,
        *,
        position: Point = ...,
        orientation: Quaternion = ...,
        check_fields: bool = ...,
    ) -> None: ...
