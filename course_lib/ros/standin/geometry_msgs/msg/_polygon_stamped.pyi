# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._polygon import Polygon
from std_msgs.msg._header import Header

class PolygonStamped(Message):
    header: Header
    polygon: Polygon
    def __init__(
        self,
        *,
        header: Header = ...,
        polygon: Polygon = ...,
        check_fields: bool = ...,
    ) -> None: ...
