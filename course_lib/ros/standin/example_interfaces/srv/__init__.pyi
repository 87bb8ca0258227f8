# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import TypeAlias

from course_lib.ros.messages.message import Message

class AddTwoInts_Request(Message):
    a: int
    b: int
    def __init__(self, *, a: int = ..., b: int = ..., check_fields: bool = ...) -> None: ...

class AddTwoInts_Response(Message):
    sum: int
    def __init__(self, *, sum: int = ..., check_fields: bool = ...) -> None: ...

class SetBool_Request(Message):
    data: bool
    def __init__(self, *, data: bool = ..., check_fields: bool = ...) -> None: ...

class SetBool_Response(Message):
    success: bool
    message: str
    def __init__(self, *, success: bool = ..., message: str = ..., check_fields: bool = ...) -> None: ...

class Trigger_Request(Message):
    def __init__(self, *, check_fields: bool = ...) -> None: ...

class Trigger_Response(Message):
    success: bool
    message: str
    def __init__(self, *, success: bool = ..., message: str = ..., check_fields: bool = ...) -> None: ...

class AddTwoInts:
    Request: TypeAlias = AddTwoInts_Request
    Response: TypeAlias = AddTwoInts_Response

class SetBool:
    Request: TypeAlias = SetBool_Request
    Response: TypeAlias = SetBool_Response

class Trigger:
    Request: TypeAlias = Trigger_Request
    Response: TypeAlias = Trigger_Response
