# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._quaternion import Quaternion
from geometry_msgs.msg._vector3 import Vector3

class Transform(Message):
    translation: Vector3
    rotation: Quaternion
    def __init__(
        self,
        *,
        translation: Vector3 = ...,
        rotation: Quaternion = ...,
        check_fields: bool = ...,
    ) -> None: ...
