# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message

class Quaternion(Message):
    X__DEFAULT: Final = 0.0
    Y__DEFAULT: Final = 0.0
    Z__DEFAULT: Final = 0.0
    W__DEFAULT: Final = 1.0
    x: float
    y: float
    z: float
    w: float
    def __init__(
        self,
        *,
        x: float = ...,
        y: float = ...,
        z: float = ...,
        w: float = ...,
        check_fields: bool = ...,
    ) -> None: ...
