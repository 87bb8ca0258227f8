# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
from std_msgs.msg._header import Header

class Joy(Message):
    header: Header
    @property
    def axes(self) -> array[float]: ...
    @axes.setter
    def axes(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    @property
    def buttons(self) -> array[int]: ...
    @buttons.setter
    def buttons(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        header: Header = ...,
        axes: Sequence[float] | NDArray[Any] = ...,
        buttons: Sequence[int] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...
