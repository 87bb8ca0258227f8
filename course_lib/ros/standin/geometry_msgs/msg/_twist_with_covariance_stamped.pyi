# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._twist_with_covariance import TwistWithCovariance
from std_msgs.msg._header import Header

class TwistWithCovarianceStamped(Message):
    header: Header
    twist: TwistWithCovariance
    def __init__(
        self,
        *,
        header: Header = ...,
        twist: TwistWithCovariance = ...,
        check_fields: bool = ...,
    ) -> None: ...
