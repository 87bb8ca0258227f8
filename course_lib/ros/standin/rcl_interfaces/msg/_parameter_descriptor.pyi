# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message
from rcl_interfaces.msg._floating_point_range import FloatingPointRange
from rcl_interfaces.msg._integer_range import IntegerRange

class ParameterDescriptor(Message):
    READ_ONLY__DEFAULT: Final = False
    DYNAMIC_TYPING__DEFAULT: Final = False
    name: str
    type: int
    description: str
    additional_constraints: str
    read_only: bool
    dynamic_typing: bool
    floating_point_range: list[FloatingPointRange]
    integer_range: list[IntegerRange]
    def __init__(
        self,
        *,
        name: str = ...,
        type: int = ...,
        description: str = ...,
        additional_constraints: str = ...,
        read_only: bool = ...,
        dynamic_typing: bool = ...,
        floating_point_range: list[FloatingPointRange] = ...,
        integer_range: list[IntegerRange] = ...,
        check_fields: bool = ...,
    ) -> None: ...
