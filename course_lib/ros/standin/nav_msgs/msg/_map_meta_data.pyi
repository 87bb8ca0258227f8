# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from builtin_interfaces.msg._time import Time
from course_lib.ros.messages.message import Message
from geometry_msgs.msg._pose import Pose

class MapMetaData(Message):
    map_load_time: Time
    resolution: float
    width: int
    height: int
    origin: Pose
    def __init__(
        self,
        *,
        map_load_time: Time = ...,
        resolution: float = ...,
        width: int = ...,
        height: int = ...,
        origin: Pose = ...,
        check_fields: bool = ...,
    ) -> None: ...
