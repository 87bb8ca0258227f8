# Written by `python -m tests.ros.messages.stubs`; don't edit.

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from course_lib.ros.messages.message import Message

class UUID(Message):
    @property
    def uuid(self) -> NDArray[np.uint8]: ...
    @uuid.setter
    def uuid(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(self, *, uuid: Sequence[int] | NDArray[Any] = ..., check_fields: bool = ...) -> None: ...
