# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class TypeSource(Message):
    type_name: str
    encoding: str
    raw_file_contents: str
    def __init__(
        self,
        *,
        type_name: str = ...,
        encoding: str = ...,
        raw_file_contents: str = ...,
        check_fields: bool = ...,
    ) -> None: ...
