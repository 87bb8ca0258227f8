# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from sensor_msgs.msg._joy_feedback import JoyFeedback

class JoyFeedbackArray(Message):
    array: list[JoyFeedback]
    def __init__(
        self,
        *,
        array: list[JoyFeedback] = ...,
        check_fields: bool = ...,
    ) -> None: ...
