# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import Final
from typing import TypeAlias

from course_lib.ros.messages.message import Message
import action_msgs.msg

class CancelGoal_Request(Message):
    goal_info: action_msgs.msg.GoalInfo
    def __init__(self, *, goal_info: action_msgs.msg.GoalInfo = ..., check_fields: bool = ...) -> None: ...

class CancelGoal_Response(Message):
    ERROR_NONE: Final = 0
    ERROR_REJECTED: Final = 1
    ERROR_UNKNOWN_GOAL_ID: Final = 2
    ERROR_GOAL_TERMINATED: Final = 3
    return_code: int
    goals_canceling: list[action_msgs.msg.GoalInfo]
    def __init__(
        self,
        *,
        return_code: int = ...,
        goals_canceling: list[action_msgs.msg.GoalInfo] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class CancelGoal:
    Request: TypeAlias = CancelGoal_Request
    Response: TypeAlias = CancelGoal_Response
