# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._inertia import Inertia
from std_msgs.msg._header import Header

class InertiaStamped(Message):
    header: Header
    inertia: Inertia
    def __init__(
        self,
        *,
        header: Header = ...,
        inertia: Inertia = ...,
        check_fields: bool = ...,
    ) -> None: ...
