# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
from std_msgs.msg._header import Header

class JointState(Message):
    header: Header
    name: list[str]
    @property
    def position(self) -> array[float]: ...
    @position.setter
    def position(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    @property
    def velocity(self) -> array[float]: ...
    @velocity.setter
    def velocity(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    @property
    def effort(self) -> array[float]: ...
    @effort.setter
    def effort(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        header: Header = ...,
        name: list[str] = ...,
        position: Sequence[float] | NDArray[Any] = ...,
        velocity: Sequence[float] | NDArray[Any] = ...,
        effort: Sequence[float] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...
