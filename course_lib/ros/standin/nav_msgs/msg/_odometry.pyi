# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._pose_with_covariance import PoseWithCovariance
from geometry_msgs.msg._twist_with_covariance import TwistWithCovariance
from std_msgs.msg._header import Header

class Odometry(Message):
    header: Header
    child_frame_id: str
    pose: PoseWithCovariance
    twist: TwistWithCovariance
    def __init__(
        self,
        *,
        header: Header = ...,
        child_frame_id: str = ...,
        pose: PoseWithCovariance = ...,
        twist: TwistWithCovariance = ...,
        check_fields: bool = ...,
    ) -> None: ...
