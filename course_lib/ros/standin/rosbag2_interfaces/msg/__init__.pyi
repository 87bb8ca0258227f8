# Written by `python -m tests.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class ReadSplitEvent(Message):
    closed_file: str
    opened_file: str
    node_name: str
    def __init__(
        self,
        *,
        closed_file: str = ...,
        opened_file: str = ...,
        node_name: str = ...,
        check_fields: bool = ...,
    ) -> None: ...

class WriteSplitEvent(Message):
    closed_file: str
    opened_file: str
    node_name: str
    def __init__(
        self,
        *,
        closed_file: str = ...,
        opened_file: str = ...,
        node_name: str = ...,
        check_fields: bool = ...,
    ) -> None: ...
