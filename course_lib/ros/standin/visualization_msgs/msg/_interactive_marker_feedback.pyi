# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._point import Point
from geometry_msgs.msg._pose import Pose
from std_msgs.msg._header import Header

class InteractiveMarkerFeedback(Message):
    KEEP_ALIVE: Final = 0
    POSE_UPDATE: Final = 1
    MENU_SELECT: Final = 2
    BUTTON_CLICK: Final = 3
    MOUSE_DOWN: Final = 4
    MOUSE_UP: Final = 5
    header: Header
    client_id: str
    marker_name: str
    control_name: str
    event_type: int
    pose: Pose
    menu_entry_id: int
    mouse_point: Point
    mouse_point_valid: bool
    def __init__(
        self,
        *,
        header: Header = ...,
        client_id: str = ...,
        marker_name: str = ...,
        control_name: str = ...,
        event_type: int = ...,
        pose: Pose = ...,
        menu_entry_id: int = ...,
        mouse_point: Point = ...,
        mouse_point_valid: bool = ...,
        check_fields: bool = ...,
    ) -> None: ...
