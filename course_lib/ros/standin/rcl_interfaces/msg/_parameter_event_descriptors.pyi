# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from rcl_interfaces.msg._parameter_descriptor import ParameterDescriptor

class ParameterEventDescriptors(Message):
    new_parameters: list[ParameterDescriptor]
    changed_parameters: list[ParameterDescriptor]
    deleted_parameters: list[ParameterDescriptor]
    def __init__(
        self,
        *,
        new_parameters: list[ParameterDescriptor] = ...,
        changed_parameters: list[ParameterDescriptor] = ...,
        deleted_parameters: list[ParameterDescriptor] = ...,
        check_fields: bool = ...,
    ) -> None: ...
