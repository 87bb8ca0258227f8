# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._polygon import Polygon

class PolygonInstance(Message):
    polygon: Polygon
    id: int
    def __init__(
        self,
        *,
        polygon: Polygon = ...,
        id: int = ...,
        check_fields: bool = ...,
    ) -> None: ...
