# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from rcl_interfaces.msg._parameter_value import ParameterValue

class Parameter(Message):
    name: str
    value: ParameterValue
    def __init__(
        self,
        *,
        name: str = ...,
        value: ParameterValue = ...,
        check_fields: bool = ...,
    ) -> None: ...
