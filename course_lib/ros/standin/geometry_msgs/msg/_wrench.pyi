# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._vector3 import Vector3

class Wrench(Message):
    force: Vector3
    torque: Vector3
    def __init__(
        self,
        *,
        force: Vector3 = ...,
        torque: Vector3 = ...,
        check_fields: bool = ...,
    ) -> None: ...
