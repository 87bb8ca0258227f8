# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from visualization_msgs.msg._interactive_marker import InteractiveMarker

class InteractiveMarkerInit(Message):
    server_id: str
    seq_num: int
    markers: list[InteractiveMarker]
    def __init__(
        self,
        *,
        server_id: str = ...,
        seq_num: int = ...,
        markers: list[InteractiveMarker] = ...,
        check_fields: bool = ...,
    ) -> None: ...
