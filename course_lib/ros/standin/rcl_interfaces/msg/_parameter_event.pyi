# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from builtin_interfaces.msg._time import Time
from course_lib.ros.messages.message import Message
from rcl_interfaces.msg._parameter import Parameter

class ParameterEvent(Message):
    stamp: Time
    node: str
    new_parameters: list[Parameter]
    changed_parameters: list[Parameter]
    deleted_parameters: list[Parameter]
    def __init__(
        self,
        *,
        stamp: Time = ...,
        node: str = ...,
        new_parameters: list[Parameter] = ...,
        changed_parameters: list[Parameter] = ...,
        deleted_parameters: list[Parameter] = ...,
        check_fields: bool = ...,
    ) -> None: ...
