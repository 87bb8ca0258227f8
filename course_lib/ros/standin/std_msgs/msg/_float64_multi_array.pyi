# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
from std_msgs.msg._multi_array_layout import MultiArrayLayout

class Float64MultiArray(Message):
    layout: MultiArrayLayout
    @property
    def data(self) -> array[float]: ...
    @data.setter
    def data(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        layout: MultiArrayLayout = ...,
        data: Sequence[float] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...
