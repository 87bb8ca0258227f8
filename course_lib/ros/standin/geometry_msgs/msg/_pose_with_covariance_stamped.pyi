# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._pose_with_covariance import PoseWithCovariance
from std_msgs.msg._header import Header

class PoseWithCovarianceStamped(Message):
    header: Header
    pose: PoseWithCovariance
    def __init__(
        self,
        *,
        header: Header = ...,
        pose: PoseWithCovariance = ...,
        check_fields: bool = ...,
    ) -> None: ...
