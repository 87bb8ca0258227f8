# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from sensor_msgs.msg._image import Image
from sensor_msgs.msg._region_of_interest import RegionOfInterest
from std_msgs.msg._header import Header

class DisparityImage(Message):
    header: Header
    image: Image
    f: float
    t: float
    valid_window: RegionOfInterest
    min_disparity: float
    max_disparity: float
    delta_d: float
    def __init__(
        self,
        *,
        header: Header = ...,
        image: Image = ...,
        f: float = ...,
        t: float = ...,
        valid_window: RegionOfInterest = ...,
        min_disparity: float = ...,
        max_disparity: float = ...,
        delta_d: float = ...,
        check_fields: bool = ...,
    ) -> None: ...
