# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from type_description_interfaces.msg._field import Field

class IndividualTypeDescription(Message):
    type_name: str
    fields: list[Field]
    def __init__(
        self,
        *,
        type_name: str = ...,
        fields: list[Field] = ...,
        check_fields: bool = ...,
    ) -> None: ...
