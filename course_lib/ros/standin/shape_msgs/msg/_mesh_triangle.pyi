# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from course_lib.ros.messages.message import Message

class MeshTriangle(Message):
    @property
    def vertex_indices(self) -> NDArray[np.uint32]: ...
    @vertex_indices.setter
    def vertex_indices(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        vertex_indices: Sequence[int] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...
