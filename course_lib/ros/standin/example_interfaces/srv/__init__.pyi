# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message

class AddTwoInts_Request(Message):
    a: int
    b: int
    def __init__(
        self,
        *,
        a: int = ...,
        b: int = ...,
        check_fields: bool = ...,
    ) -> None: ...

class AddTwoInts_Response(Message):
    sum: int
    def __init__(
        self,
        *,
        sum: int = ...,
        check_fields: bool = ...,
    ) -> None: ...

class SetBool_Request(Message):
    data: bool
    def __init__(
        self,
        *,
        data: bool = ...,
        check_fields: bool = ...,
    ) -> None: ...

class SetBool_Response(Message):
    success: bool
    message: str
    def __init__(
        self,
        *,
        success: bool = ...,
        message: str = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Trigger_Request(Message):
    def __init__(
        self,
        *,
        check_fields: bool = ...,
    ) -> None: ...

class Trigger_Response(Message):
    success: bool
    message: str
    def __init__(
        self,
        *,
        success: bool = ...,
        message: str = ...,
        check_fields: bool = ...,
    ) -> None: ...

class AddTwoInts:
    Request = AddTwoInts_Request
    Response = AddTwoInts_Response

class SetBool:
    Request = SetBool_Request
    Response = SetBool_Response

class Trigger:
    Request = Trigger_Request
    Response = Trigger_Response
