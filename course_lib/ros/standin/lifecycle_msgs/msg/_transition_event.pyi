# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from lifecycle_msgs.msg._state import State
from lifecycle_msgs.msg._transition import Transition

class TransitionEvent(Message):
    timestamp: int
    transition: Transition
    start_state: State
    goal_state: State
    def __init__(
        self,
        *,
        timestamp: int = ...,
        transition: Transition = ...,
        start_state: State = ...,
        goal_state: State = ...,
        check_fields: bool = ...,
    ) -> None: ...
