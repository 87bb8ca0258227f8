# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from std_msgs.msg._multi_array_dimension import MultiArrayDimension

class MultiArrayLayout(Message):
    dim: list[MultiArrayDimension]
    data_offset: int
    def __init__(
        self,
        *,
        dim: list[MultiArrayDimension] = ...,
        data_offset: int = ...,
        check_fields: bool = ...,
    ) -> None: ...
