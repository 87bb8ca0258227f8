# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._transform_stamped import TransformStamped

class TFMessage(Message):
    transforms: list[TransformStamped]
    def __init__(
        self,
        *,
        transforms: list[TransformStamped] = ...,
        check_fields: bool = ...,
    ) -> None: ...
