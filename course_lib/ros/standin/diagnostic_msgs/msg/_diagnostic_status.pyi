# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message
from diagnostic_msgs.msg._key_value import KeyValue

class DiagnosticStatus(Message):
    OK: Final = b"\x00"
    WARN: Final = b"\x01"
    ERROR: Final = b"\x02"
    STALE: Final = b"\x03"
    level: bytes
    name: str
    message: str
    hardware_id: str
    values: list[KeyValue]
    def __init__(
        self,
        *,
        level: bytes = ...,
        name: str = ...,
        message: str = ...,
        hardware_id: str = ...,
        values: list[KeyValue] = ...,
        check_fields: bool = ...,
    ) -> None: ...
