# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._vector3 import Vector3

class Accel(Message):
    linear: Vector3
    angular: Vector3
    def __init__(
        self,
        *,
        linear: Vector3 = ...,
        angular: Vector3 = ...,
        check_fields: bool = ...,
    ) -> None: ...
