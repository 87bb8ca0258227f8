# Written by `python -m tests.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
import builtin_interfaces.msg

class Clock(Message):
    clock: builtin_interfaces.msg.Time
    def __init__(self, *, clock: builtin_interfaces.msg.Time = ..., check_fields: bool = ...) -> None: ...
