# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from sensor_msgs.msg._laser_echo import LaserEcho
from std_msgs.msg._header import Header

class MultiEchoLaserScan(Message):
    header: Header
    angle_min: float
    angle_max: float
    angle_increment: float
    time_increment: float
    scan_time: float
    range_min: float
    range_max: float
    ranges: list[LaserEcho]
    intensities: list[LaserEcho]
    def __init__(
        self,
        *,
        header: Header = ...,
        angle_min: float = ...,
        angle_max: float = ...,
        angle_increment: float = ...,
        time_increment: float = ...,
        scan_time: float = ...,
        range_min: float = ...,
        range_max: float = ...,
        ranges: list[LaserEcho] = ...,
        intensities: list[LaserEcho] = ...,
        check_fields: bool = ...,
    ) -> None: ...
