# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from type_description_interfaces.msg._individual_type_description import IndividualTypeDescription

class TypeDescription(Message):
    type_description: IndividualTypeDescription
    referenced_type_descriptions: list[IndividualTypeDescription]
    def __init__(
        self,
        *,
        type_description: IndividualTypeDescription = ...,
        referenced_type_descriptions: list[IndividualTypeDescription] = ...,
        check_fields: bool = ...,
    ) -> None: ...
