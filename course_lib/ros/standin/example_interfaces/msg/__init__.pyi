# Written by `python -m tests.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class Bool(Message):
    data: bool
    def __init__(self, *, data: bool = ..., check_fields: bool = ...) -> None: ...

class Float64(Message):
    data: float
    def __init__(self, *, data: float = ..., check_fields: bool = ...) -> None: ...

class Int64(Message):
    data: int
    def __init__(self, *, data: int = ..., check_fields: bool = ...) -> None: ...

class String(Message):
    data: str
    def __init__(self, *, data: str = ..., check_fields: bool = ...) -> None: ...
