# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message
import actionlib_msgs.msg
import builtin_interfaces.msg
import std_msgs.msg

class GoalID(Message):
    stamp: builtin_interfaces.msg.Time
    id: str
    def __init__(
        self,
        *,
        stamp: builtin_interfaces.msg.Time = ...,
        id: str = ...,
        check_fields: bool = ...,
    ) -> None: ...

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
    goal_id: actionlib_msgs.msg.GoalID
    status: int
    text: str
    def __init__(
        self,
        *,
        goal_id: actionlib_msgs.msg.GoalID = ...,
        status: int = ...,
        text: str = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GoalStatusArray(Message):
    header: std_msgs.msg.Header
    status_list: list[actionlib_msgs.msg.GoalStatus]
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        status_list: list[actionlib_msgs.msg.GoalStatus] = ...,
        check_fields: bool = ...,
    ) -> None: ...
