# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._polygon_instance import PolygonInstance
from std_msgs.msg._header import Header

class PolygonInstanceStamped(Message):
    header: Header
    polygon: PolygonInstance
    def __init__(
        self,
        *,
        header: Header = ...,
        polygon: PolygonInstance = ...,
        check_fields: bool = ...,
    ) -> None: ...
