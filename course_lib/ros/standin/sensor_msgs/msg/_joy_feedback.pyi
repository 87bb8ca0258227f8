# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message

class JoyFeedback(Message):
    TYPE_LED: Final = 0
    TYPE_RUMBLE: Final = 1
    TYPE_BUZZER: Final = 2
    type: int
    id: int
    intensity: float
    def __init__(
        self,
        *,
        type: int = ...,
        id: int = ...,
        intensity: float = ...,
        check_fields: bool = ...,
    ) -> None: ...
