# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from action_msgs.msg._goal_info import GoalInfo
from course_lib.ros.messages.message import Message

class GoalStatus(Message):
    STATUS_UNKNOWN: Final = 0
    STATUS_ACCEPTED: Final = 1
    STATUS_EXECUTING: Final = 2
    STATUS_CANCELING: Final = 3
    STATUS_SUCCEEDED: Final = 4
    STATUS_CANCELED: Final = 5
    STATUS_ABORTED: Final = 6
    goal_info: GoalInfo
    status: int
    def __init__(
        self,
        *,
        goal_info: GoalInfo = ...,
        status: int = ...,
        check_fields: bool = ...,
    ) -> None: ...
