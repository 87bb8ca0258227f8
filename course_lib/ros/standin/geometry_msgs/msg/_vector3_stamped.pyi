# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._vector3 import Vector3
from std_msgs.msg._header import Header

class Vector3Stamped(Message):
    header: Header
    vector: Vector3
    def __init__(
        self,
        *,
        header: Header = ...,
        vector: Vector3 = ...,
        check_fields: bool = ...,
    ) -> None: ...
