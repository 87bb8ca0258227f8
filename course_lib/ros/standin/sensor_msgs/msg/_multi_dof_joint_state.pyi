# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._transform import Transform
from geometry_msgs.msg._twist import Twist
from geometry_msgs.msg._wrench import Wrench
from std_msgs.msg._header import Header

class MultiDOFJointState(Message):
    header: Header
    joint_names: list[str]
    transforms: list[Transform]
    twist: list[Twist]
    wrench: list[Wrench]
    def __init__(
        self,
        *,
        header: Header = ...,
        joint_names: list[str] = ...,
        transforms: list[Transform] = ...,
        twist: list[Twist] = ...,
        wrench: list[Wrench] = ...,
        check_fields: bool = ...,
    ) -> None: ...
