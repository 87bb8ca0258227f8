# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message
import action_msgs.msg
import builtin_interfaces.msg
import unique_identifier_msgs.msg

class GoalInfo(Message):
    goal_id: unique_identifier_msgs.msg.UUID
    stamp: builtin_interfaces.msg.Time
    def __init__(
        self,
        *,
        goal_id: unique_identifier_msgs.msg.UUID = ...,
        stamp: builtin_interfaces.msg.Time = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GoalStatus(Message):
    STATUS_UNKNOWN: Final = 0
    STATUS_ACCEPTED: Final = 1
    STATUS_EXECUTING: Final = 2
    STATUS_CANCELING: Final = 3
    STATUS_SUCCEEDED: Final = 4
    STATUS_CANCELED: Final = 5
    STATUS_ABORTED: Final = 6
    goal_info: action_msgs.msg.GoalInfo
    status: int
    def __init__(
        self,
        *,
        goal_info: action_msgs.msg.GoalInfo = ...,
        status: int = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GoalStatusArray(Message):
    status_list: list[action_msgs.msg.GoalStatus]
    def __init__(
        self,
        *,
        status_list: list[action_msgs.msg.GoalStatus] = ...,
        check_fields: bool = ...,
    ) -> None: ...
