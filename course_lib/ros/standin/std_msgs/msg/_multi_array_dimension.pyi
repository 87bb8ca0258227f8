# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class MultiArrayDimension(Message):
    label: str
    size: int
    stride: int
    def __init__(
        self,
        *,
        label: str = ...,
        size: int = ...,
        stride: int = ...,
        check_fields: bool = ...,
    ) -> None: ...
