# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from std_msgs.msg._header import Header
from trajectory_msgs.msg._multi_dof_joint_trajectory_point import MultiDOFJointTrajectoryPoint

class MultiDOFJointTrajectory(Message):
    header: Header
    joint_names: list[str]
    points: list[MultiDOFJointTrajectoryPoint]
    def __init__(
        self,
        *,
        header: Header = ...,
        joint_names: list[str] = ...,
        points: list[MultiDOFJointTrajectoryPoint] = ...,
        check_fields: bool = ...,
    ) -> None: ...
