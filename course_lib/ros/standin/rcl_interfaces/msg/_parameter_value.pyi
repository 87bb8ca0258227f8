# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message

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
