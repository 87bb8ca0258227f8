# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._point32 import Point32

class Polygon(Message):
    points: list[Point32]
    def __init__(
        self,
        *,
        points: list[Point32] = ...,
        check_fields: bool = ...,
    ) -> None: ...
