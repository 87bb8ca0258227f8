# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from type_description_interfaces.msg._field_type import FieldType

class Field(Message):
    name: str
    type: FieldType
    default_value: str
    def __init__(
        self,
        *,
        name: str = ...,
        type: FieldType = ...,
        default_value: str = ...,
        check_fields: bool = ...,
    ) -> None: ...
