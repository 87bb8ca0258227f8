# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import TypeAlias

from course_lib.ros.messages.message import Message

class FrameGraph_Request(Message):
    def __init__(self, *, check_fields: bool = ...) -> None: ...

class FrameGraph_Response(Message):
    frame_yaml: str
    def __init__(self, *, frame_yaml: str = ..., check_fields: bool = ...) -> None: ...

class FrameGraph:
    Request: TypeAlias = FrameGraph_Request
    Response: TypeAlias = FrameGraph_Response
