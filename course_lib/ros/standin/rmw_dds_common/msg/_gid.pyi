# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from course_lib.ros.messages.message import Message

class Gid(Message):
    @property
    def data(self) -> NDArray[np.uint8]: ...
    @data.setter
    def data(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        data: Sequence[int] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...
