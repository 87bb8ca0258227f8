# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class ListParametersResult(Message):
    names: list[str]
    prefixes: list[str]
    def __init__(
        self,
        *,
        names: list[str] = ...,
        prefixes: list[str] = ...,
        check_fields: bool = ...,
    ) -> None: ...
