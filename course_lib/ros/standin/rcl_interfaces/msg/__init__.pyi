# Written by `python -m tests.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any
from typing import Final

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
import builtin_interfaces.msg
import rcl_interfaces.msg

class FloatingPointRange(Message):
    from_value: float
    to_value: float
    step: float
    def __init__(
        self,
        *,
        from_value: float = ...,
        to_value: float = ...,
        step: float = ...,
        check_fields: bool = ...,
    ) -> None: ...

class IntegerRange(Message):
    from_value: int
    to_value: int
    step: int
    def __init__(
        self,
        *,
        from_value: int = ...,
        to_value: int = ...,
        step: int = ...,
        check_fields: bool = ...,
    ) -> None: ...

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

class Log(Message):
    DEBUG: Final = 10
    INFO: Final = 20
    WARN: Final = 30
    ERROR: Final = 40
    FATAL: Final = 50
    stamp: builtin_interfaces.msg.Time
    level: int
    name: str
    msg: str
    file: str
    function: str
    line: int
    def __init__(
        self,
        *,
        stamp: builtin_interfaces.msg.Time = ...,
        level: int = ...,
        name: str = ...,
        msg: str = ...,
        file: str = ...,
        function: str = ...,
        line: int = ...,
        check_fields: bool = ...,
    ) -> None: ...

class LoggerLevel(Message):
    LOG_LEVEL_UNKNOWN: Final = 0
    LOG_LEVEL_DEBUG: Final = 10
    LOG_LEVEL_INFO: Final = 20
    LOG_LEVEL_WARN: Final = 30
    LOG_LEVEL_ERROR: Final = 40
    LOG_LEVEL_FATAL: Final = 50
    name: str
    level: int
    def __init__(self, *, name: str = ..., level: int = ..., check_fields: bool = ...) -> None: ...

class Parameter(Message):
    name: str
    value: rcl_interfaces.msg.ParameterValue
    def __init__(
        self,
        *,
        name: str = ...,
        value: rcl_interfaces.msg.ParameterValue = ...,
        check_fields: bool = ...,
    ) -> None: ...

class ParameterDescriptor(Message):
    READ_ONLY__DEFAULT: Final = False
    DYNAMIC_TYPING__DEFAULT: Final = False
    name: str
    type: int
    description: str
    additional_constraints: str
    read_only: bool
    dynamic_typing: bool
    floating_point_range: list[rcl_interfaces.msg.FloatingPointRange]
    integer_range: list[rcl_interfaces.msg.IntegerRange]
    def __init__(
        self,
        *,
        name: str = ...,
        type: int = ...,
        description: str = ...,
        additional_constraints: str = ...,
        read_only: bool = ...,
        dynamic_typing: bool = ...,
        floating_point_range: list[rcl_interfaces.msg.FloatingPointRange] = ...,
        integer_range: list[rcl_interfaces.msg.IntegerRange] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class ParameterEvent(Message):
    stamp: builtin_interfaces.msg.Time
    node: str
    new_parameters: list[rcl_interfaces.msg.Parameter]
    changed_parameters: list[rcl_interfaces.msg.Parameter]
    deleted_parameters: list[rcl_interfaces.msg.Parameter]
    def __init__(
        self,
        *,
        stamp: builtin_interfaces.msg.Time = ...,
        node: str = ...,
        new_parameters: list[rcl_interfaces.msg.Parameter] = ...,
        changed_parameters: list[rcl_interfaces.msg.Parameter] = ...,
        deleted_parameters: list[rcl_interfaces.msg.Parameter] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class ParameterEventDescriptors(Message):
    new_parameters: list[rcl_interfaces.msg.ParameterDescriptor]
    changed_parameters: list[rcl_interfaces.msg.ParameterDescriptor]
    deleted_parameters: list[rcl_interfaces.msg.ParameterDescriptor]
    def __init__(
        self,
        *,
        new_parameters: list[rcl_interfaces.msg.ParameterDescriptor] = ...,
        changed_parameters: list[rcl_interfaces.msg.ParameterDescriptor] = ...,
        deleted_parameters: list[rcl_interfaces.msg.ParameterDescriptor] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class ParameterType(Message):
    PARAMETER_NOT_SET: Final = 0
    PARAMETER_BOOL: Final = 1
    PARAMETER_INTEGER: Final = 2
    PARAMETER_DOUBLE: Final = 3
    PARAMETER_STRING: Final = 4
    PARAMETER_BYTE_ARRAY: Final = 5
    PARAMETER_BOOL_ARRAY: Final = 6
    PARAMETER_INTEGER_ARRAY: Final = 7
    PARAMETER_DOUBLE_ARRAY: Final = 8
    PARAMETER_STRING_ARRAY: Final = 9
    def __init__(self, *, check_fields: bool = ...) -> None: ...

class ParameterValue(Message):
    type: int
    bool_value: bool
    integer_value: int
    double_value: float
    string_value: str
    byte_array_value: list[bytes]
    bool_array_value: list[bool]
    @property
    def integer_array_value(self) -> array[int]: ...
    @integer_array_value.setter
    def integer_array_value(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    @property
    def double_array_value(self) -> array[float]: ...
    @double_array_value.setter
    def double_array_value(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    string_array_value: list[str]
    def __init__(
        self,
        *,
        type: int = ...,
        bool_value: bool = ...,
        integer_value: int = ...,
        double_value: float = ...,
        string_value: str = ...,
        byte_array_value: list[bytes] = ...,
        bool_array_value: list[bool] = ...,
        integer_array_value: Sequence[int] | NDArray[Any] = ...,
        double_array_value: Sequence[float] | NDArray[Any] = ...,
        string_array_value: list[str] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class SetLoggerLevelsResult(Message):
    successful: bool
    reason: str
    def __init__(self, *, successful: bool = ..., reason: str = ..., check_fields: bool = ...) -> None: ...

class SetParametersResult(Message):
    successful: bool
    reason: str
    def __init__(self, *, successful: bool = ..., reason: str = ..., check_fields: bool = ...) -> None: ...
