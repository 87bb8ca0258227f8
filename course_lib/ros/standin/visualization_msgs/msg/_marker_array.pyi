# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from visualization_msgs.msg._marker import Marker

class MarkerArray(Message):
    markers: list[Marker]
    def __init__(
        self,
        *,
        markers: list[Marker] = ...,
        check_fields: bool = ...,
    ) -> None: ...
