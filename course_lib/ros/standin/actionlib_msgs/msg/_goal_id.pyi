# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from builtin_interfaces.msg._time import Time
from course_lib.ros.messages.message import Message

class GoalID(Message):
    stamp: Time
    id: str
    def __init__(
        self,
        *,
        stamp: Time = ...,
        id: str = ...,
        check_fields: bool = ...,
    ) -> None: ...
