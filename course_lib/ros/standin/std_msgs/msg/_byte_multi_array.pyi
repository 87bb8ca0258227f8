# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from std_msgs.msg._multi_array_layout import MultiArrayLayout

class ByteMultiArray(Message):
    layout: MultiArrayLayout
    data: list[bytes]
    def __init__(
        self,
        *,
        layout: MultiArrayLayout = ...,
        data: list[bytes] = ...,
        check_fields: bool = ...,
    ) -> None: ...
