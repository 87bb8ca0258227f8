# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message
import diagnostic_msgs.msg
import std_msgs.msg

class DiagnosticArray(Message):
    header: std_msgs.msg.Header
    status: list[diagnostic_msgs.msg.DiagnosticStatus]
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        status: list[diagnostic_msgs.msg.DiagnosticStatus] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class DiagnosticStatus(Message):
    OK: Final = b"\x00"
    WARN: Final = b"\x01"
    ERROR: Final = b"\x02"
    STALE: Final = b"\x03"
    level: bytes
    name: str
    message: str
    hardware_id: str
    values: list[diagnostic_msgs.msg.KeyValue]
    def __init__(
        self,
        *,
        level: bytes = ...,
        name: str = ...,
        message: str = ...,
        hardware_id: str = ...,
        values: list[diagnostic_msgs.msg.KeyValue] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class KeyValue(Message):
    key: str
    value: str
    def __init__(self, *, key: str = ..., value: str = ..., check_fields: bool = ...) -> None: ...
