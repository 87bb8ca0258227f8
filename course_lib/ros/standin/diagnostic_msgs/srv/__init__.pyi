# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import TypeAlias

from course_lib.ros.messages.message import Message
import diagnostic_msgs.msg

class AddDiagnostics_Request(Message):
    load_namespace: str
    def __init__(self, *, load_namespace: str = ..., check_fields: bool = ...) -> None: ...

class AddDiagnostics_Response(Message):
    success: bool
    message: str
    def __init__(self, *, success: bool = ..., message: str = ..., check_fields: bool = ...) -> None: ...

class SelfTest_Request(Message):
    def __init__(self, *, check_fields: bool = ...) -> None: ...

class SelfTest_Response(Message):
    id: str
    passed: bytes
    status: list[diagnostic_msgs.msg.DiagnosticStatus]
    def __init__(
        self,
        *,
        id: str = ...,
        passed: bytes = ...,
        status: list[diagnostic_msgs.msg.DiagnosticStatus] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class AddDiagnostics:
    Request: TypeAlias = AddDiagnostics_Request
    Response: TypeAlias = AddDiagnostics_Response

class SelfTest:
    Request: TypeAlias = SelfTest_Request
    Response: TypeAlias = SelfTest_Response
