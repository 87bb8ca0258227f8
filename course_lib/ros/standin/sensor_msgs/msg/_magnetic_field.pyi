# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._vector3 import Vector3
from std_msgs.msg._header import Header

class MagneticField(Message):
    header: Header
    magnetic_field: Vector3
    @property
    def magnetic_field_covariance(self) -> NDArray[np.float64]: ...
    @magnetic_field_covariance.setter
    def magnetic_field_covariance(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        header: Header = ...,
        magnetic_field: Vector3 = ...,
        magnetic_field_covariance: Sequence[float] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...
