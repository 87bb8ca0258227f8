# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from action_msgs.msg._goal_status import GoalStatus
from course_lib.ros.messages.message import Message

class GoalStatusArray(Message):
    status_list: list[GoalStatus]
    def __init__(
        self,
        *,
        status_list: list[GoalStatus] = ...,
        check_fields: bool = ...,
    ) -> None: ...
