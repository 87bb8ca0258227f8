# Written by `python -m tests.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
import sensor_msgs.msg
import std_msgs.msg

class DisparityImage(Message):
    header: std_msgs.msg.Header
    image: sensor_msgs.msg.Image
    f: float
    t: float
    valid_window: sensor_msgs.msg.RegionOfInterest
    min_disparity: float
    max_disparity: float
    delta_d: float
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        image: sensor_msgs.msg.Image = ...,
        f: float = ...,
        t: float = ...,
        valid_window: sensor_msgs.msg.RegionOfInterest = ...,
        min_disparity: float = ...,
        max_disparity: float = ...,
        delta_d: float = ...,
        check_fields: bool = ...,
    ) -> None: ...
