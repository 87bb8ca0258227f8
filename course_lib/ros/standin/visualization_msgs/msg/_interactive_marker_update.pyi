# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message
from visualization_msgs.msg._interactive_marker import InteractiveMarker
from visualization_msgs.msg._interactive_marker_pose import InteractiveMarkerPose

class InteractiveMarkerUpdate(Message):
    KEEP_ALIVE: Final = 0
    UPDATE: Final = 1
    server_id: str
    seq_num: int
    type: int
    markers: list[InteractiveMarker]
    poses: list[InteractiveMarkerPose]
    erases: list[str]
    def __init__(
        self,
        *,
        server_id: str = ...,
        seq_num: int = ...,
        type: int = ...,
        markers: list[InteractiveMarker] = ...,
        poses: list[InteractiveMarkerPose] = ...,
        erases: list[str] = ...,
        check_fields: bool = ...,
    ) -> None: ...
