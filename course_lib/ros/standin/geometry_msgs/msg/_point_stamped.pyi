# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._point import Point
from std_msgs.msg._header import Header

class PointStamped(Message):
    header: Header
    point: Point
    def __init__(
        self,
        *,
        header: Header = ...,
        point: Point = ...,
        check_fields: bool = ...,
    ) -> None: ...
