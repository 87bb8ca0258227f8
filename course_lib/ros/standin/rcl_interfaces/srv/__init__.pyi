# Written by `python -m tests.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any
from typing import Final
from typing import TypeAlias

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
import rcl_interfaces.msg

class DescribeParameters_Request(Message):
    names: list[str]
    def __init__(self, *, names: list[str] = ..., check_fields: bool = ...) -> None: ...

class DescribeParameters_Response(Message):
    descriptors: list[rcl_interfaces.msg.ParameterDescriptor]
    def __init__(
        self,
        *,
        descriptors: list[rcl_interfaces.msg.ParameterDescriptor] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GetLoggerLevels_Request(Message):
    names: list[str]
    def __init__(self, *, names: list[str] = ..., check_fields: bool = ...) -> None: ...

class GetLoggerLevels_Response(Message):
    levels: list[rcl_interfaces.msg.LoggerLevel]
    def __init__(
        self,
        *,
        levels: list[rcl_interfaces.msg.LoggerLevel] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GetParameterTypes_Request(Message):
    names: list[str]
    def __init__(self, *, names: list[str] = ..., check_fields: bool = ...) -> None: ...

class GetParameterTypes_Response(Message):
    @property
    def types(self) -> array[int]: ...
    @types.setter
    def types(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(self, *, types: Sequence[int] | NDArray[Any] = ..., check_fields: bool = ...) -> None: ...

class GetParameters_Request(Message):
    names: list[str]
    def __init__(self, *, names: list[str] = ..., check_fields: bool = ...) -> None: ...

class GetParameters_Response(Message):
    values: list[rcl_interfaces.msg.ParameterValue]
    def __init__(
        self,
        *,
        values: list[rcl_interfaces.msg.ParameterValue] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class ListParameters_Request(Message):
    DEPTH_RECURSIVE: Final = 0
    prefixes: list[str]
    depth: int
    def __init__(self, *, prefixes: list[str] = ..., depth: int = ..., check_fields: bool = ...) -> None: ...

class ListParameters_Response(Message):
    result: rcl_interfaces.msg.ListParametersResult
    def __init__(
        self,
        *,
        result: rcl_interfaces.msg.ListParametersResult = ...,
        check_fields: bool = ...,
    ) -> None: ...

class SetLoggerLevels_Request(Message):
    levels: list[rcl_interfaces.msg.LoggerLevel]
    def __init__(
        self,
        *,
        levels: list[rcl_interfaces.msg.LoggerLevel] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class SetLoggerLevels_Response(Message):
    results: list[rcl_interfaces.msg.SetLoggerLevelsResult]
    def __init__(
        self,
        *,
        results: list[rcl_interfaces.msg.SetLoggerLevelsResult] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class SetParametersAtomically_Request(Message):
    parameters: list[rcl_interfaces.msg.Parameter]
    def __init__(
        self,
        *,
        parameters: list[rcl_interfaces.msg.Parameter] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class SetParametersAtomically_Response(Message):
    result: rcl_interfaces.msg.SetParametersResult
    def __init__(
        self,
        *,
        result: rcl_interfaces.msg.SetParametersResult = ...,
        check_fields: bool = ...,
    ) -> None: ...

class SetParameters_Request(Message):
    parameters: list[rcl_interfaces.msg.Parameter]
    def __init__(
        self,
        *,
        parameters: list[rcl_interfaces.msg.Parameter] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class SetParameters_Response(Message):
    results: list[rcl_interfaces.msg.SetParametersResult]
    def __init__(
        self,
        *,
        results: list[rcl_interfaces.msg.SetParametersResult] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class DescribeParameters:
    Request: TypeAlias = DescribeParameters_Request
    Response: TypeAlias = DescribeParameters_Response

class GetLoggerLevels:
    Request: TypeAlias = GetLoggerLevels_Request
    Response: TypeAlias = GetLoggerLevels_Response

class GetParameterTypes:
    Request: TypeAlias = GetParameterTypes_Request
    Response: TypeAlias = GetParameterTypes_Response

class GetParameters:
    Request: TypeAlias = GetParameters_Request
    Response: TypeAlias = GetParameters_Response

class ListParameters:
    Request: TypeAlias = ListParameters_Request
    Response: TypeAlias = ListParameters_Response

class SetLoggerLevels:
    Request: TypeAlias = SetLoggerLevels_Request
    Response: TypeAlias = SetLoggerLevels_Response

class SetParametersAtomically:
    Request: TypeAlias = SetParametersAtomically_Request
    Response: TypeAlias = SetParametersAtomically_Response

class SetParameters:
    Request: TypeAlias = SetParameters_Request
    Response: TypeAlias = SetParameters_Response
