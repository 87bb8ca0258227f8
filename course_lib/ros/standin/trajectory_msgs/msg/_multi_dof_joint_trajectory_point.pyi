# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from builtin_interfaces.msg._duration import Duration
from course_lib.ros.messages.message import Message
from geometry_msgs.msg._transform import Transform
from geometry_msgs.msg._twist import Twist

class MultiDOFJointTrajectoryPoint(Message):
    transforms: list[Transform]
    velocities: list[Twist]
    accelerations: list[Twist]
    time_from_start: Duration
    def __init__(
        self,
        *,
        transforms: list[Transform] = ...,
        velocities: list[Twist] = ...,
        accelerations: list[Twist] = ...,
        time_from_start: Duration = ...,
        check_fields: bool = ...,
    ) -> None: ...
