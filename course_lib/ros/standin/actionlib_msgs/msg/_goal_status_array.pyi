# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from actionlib_msgs.msg._goal_status import GoalStatus
from course_lib.ros.messages.message import Message
from std_msgs.msg._header import Header

class GoalStatusArray(Message):
    header: Header
    status_list: list[GoalStatus]
    def __init__(
        self,
        *,
        header: Header = ...,
        status_list: list[GoalStatus] = ...,
        check_fields: bool = ...,
    ) -> None: ...
