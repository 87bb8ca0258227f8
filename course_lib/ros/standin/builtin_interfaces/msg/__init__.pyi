# Written by `python -m tests.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class Duration(Message):
    sec: int
    nanosec: int
    def __init__(self, *, sec: int = ..., nanosec: int = ..., check_fields: bool = ...) -> None: ...

class Time(Message):
    sec: int
    nanosec: int
    def __init__(self, *, sec: int = ..., nanosec: int = ..., check_fields: bool = ...) -> None: ...
