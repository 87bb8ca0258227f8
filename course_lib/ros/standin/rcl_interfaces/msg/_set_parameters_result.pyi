# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class SetParametersResult(Message):
    successful: bool
    reason: str
    def __init__(
        self,
        *,
        successful: bool = ...,
        reason: str = ...,
        check_fields: bool = ...,
    ) -> None: ...
