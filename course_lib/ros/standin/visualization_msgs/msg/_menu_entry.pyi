# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from course_lib.ros.messages.message import Message

class MenuEntry(Message):
    FEEDBACK: Final = 0
    ROSRUN: Final = 1
    ROSLAUNCH: Final = 2
    id: int
    parent_id: int
    title: str
    command: str
    command_type: int
    def __init__(
        self,
        *,
        id: int = ...,
        parent_id: int = ...,
        title: str = ...,
        command: str = ...,
        command_type: int = ...,
        check_fields: bool = ...,
    ) -> None: ...
