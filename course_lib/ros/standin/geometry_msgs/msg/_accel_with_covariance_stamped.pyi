# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._accel_with_covariance import AccelWithCovariance
from std_msgs.msg._header import Header

class AccelWithCovarianceStamped(Message):
    header: Header
    accel: AccelWithCovariance
    def __init__(
        self,
        *,
        header: Header = ...,
        accel: AccelWithCovariance = ...,
        check_fields: bool = ...,
    ) -> None: ...
