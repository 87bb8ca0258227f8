# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from builtin_interfaces.msg._time import Time
from course_lib.ros.messages.message import Message
from unique_identifier_msgs.msg._uuid import UUID

class GoalInfo(Message):
    goal_id: UUID
    stamp: Time
    def __init__(
        self,
        *,
        goal_id: UUID = ...,
        stamp: Time = ...,
        check_fields: bool = ...,
    ) -> None: ...
