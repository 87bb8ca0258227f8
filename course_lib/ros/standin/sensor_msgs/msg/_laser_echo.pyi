# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message

class LaserEcho(Message):
    @property
    def echoes(self) -> array[float]: ...
    @echoes.setter
    def echoes(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        echoes: Sequence[float] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...
