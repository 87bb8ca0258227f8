# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from std_msgs.msg._header import Header
from trajectory_msgs.msg._joint_trajectory_point import JointTrajectoryPoint

class JointTrajectory(Message):
    header: Header
    joint_names: list[str]
    points: list[JointTrajectoryPoint]
    def __init__(
        self,
        *,
        header: Header = ...,
        joint_names: list[str] = ...,
        points: list[JointTrajectoryPoint] = ...,
        check_fields: bool = ...,
    ) -> None: ...
