# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._point32 import Point32
from sensor_msgs.msg._channel_float32 import ChannelFloat32
from std_msgs.msg._header import Header

class PointCloud(Message):
    header: Header
    points: list[Point32]
    channels: list[ChannelFloat32]
    def __init__(
        self,
        *,
        header: Header = ...,
        points: list[Point32] = ...,
        channels: list[ChannelFloat32] = ...,
        check_fields: bool = ...,
    ) -> None: ...
