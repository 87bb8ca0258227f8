# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from actionlib_msgs.msg._goal_id import GoalID
from course_lib.ros.messages.message import Message

class GoalStatus(Message):
    PENDING: Final = 0
    ACTIVE: Final = 1
    PREEMPTED: Final = 2
    SUCCEEDED: Final = 3
    ABORTED: Final = 4
    REJECTED: Final = 5
    PREEMPTING: Final = 6
    RECALLING: Final = 7
    RECALLED: Final = 8
    LOST: Final = 9
    goal_id: GoalID
    status: int
    text: str
    def __init__(
        self,
        *,
        goal_id: GoalID = ...,
        status: int = ...,
        text: str = ...,
        check_fields: bool = ...,
    ) -> None: ...
