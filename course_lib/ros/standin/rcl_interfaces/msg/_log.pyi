# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from builtin_interfaces.msg._time import Time
from course_lib.ros.messages.message import Message

class Log(Message):
    DEBUG: Final = 10
    INFO: Final = 20
    WARN: Final = 30
    ERROR: Final = 40
    FATAL: Final = 50
    stamp: Time
    level: int
    name: str
    msg: str
    file: str
    function: str
    line: int
    def __init__(
        self,
        *,
        stamp: Time = ...,
        level: int = ...,
        name: str = ...,
        msg: str = ...,
        file: str = ...,
        function: str = ...,
        line: int = ...,
        check_fields: bool = ...,
    ) -> None: ...
