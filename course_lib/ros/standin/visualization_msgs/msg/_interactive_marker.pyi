# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._pose import Pose
from std_msgs.msg._header import Header
from visualization_msgs.msg._interactive_marker_control import InteractiveMarkerControl
from visualization_msgs.msg._menu_entry import MenuEntry

class InteractiveMarker(Message):
    header: Header
    pose: Pose
    name: str
    description: str
    scale: float
    menu_entries: list[MenuEntry]
    controls: list[InteractiveMarkerControl]
    def __init__(
        self,
        *,
        header: Header = ...,
        pose: Pose = ...,
        name: str = ...,
        description: str = ...,
        scale: float = ...,
        menu_entries: list[MenuEntry] = ...,
        controls: list[InteractiveMarkerControl] = ...,
        check_fields: bool = ...,
    ) -> None: ...
