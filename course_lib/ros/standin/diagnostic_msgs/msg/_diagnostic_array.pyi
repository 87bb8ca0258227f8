# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from diagnostic_msgs.msg._diagnostic_status import DiagnosticStatus
from std_msgs.msg._header import Header

class DiagnosticArray(Message):
    header: Header
    status: list[DiagnosticStatus]
    def __init__(
        self,
        *,
        header: Header = ...,
        status: list[DiagnosticStatus] = ...,
        check_fields: bool = ...,
    ) -> None: ...
