# Written by `python -m tests.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
import std_msgs.msg

class OccupancyGridUpdate(Message):
    header: std_msgs.msg.Header
    x: int
    y: int
    width: int
    height: int
    @property
    def data(self) -> array[int]: ...
    @data.setter
    def data(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        x: int = ...,
        y: int = ...,
        width: int = ...,
        height: int = ...,
        data: Sequence[int] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...
