# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._accel import Accel

class AccelWithCovariance(Message):
    accel: Accel
    @property
    def covariance(self) -> NDArray[np.float64]: ...
    @covariance.setter
    def covariance(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        accel: Accel = ...,
        covariance: Sequence[float] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...
