# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
from sensor_msgs.msg._nav_sat_status import NavSatStatus
from std_msgs.msg._header import Header

class NavSatFix(Message):
    COVARIANCE_TYPE_UNKNOWN: Final = 0
    COVARIANCE_TYPE_APPROXIMATED: Final = 1
    COVARIANCE_TYPE_DIAGONAL_KNOWN: Final = 2
    COVARIANCE_TYPE_KNOWN: Final = 3
    header: Header
    status: NavSatStatus
    latitude: float
    longitude: float
    altitude: float
    @property
    def position_covariance(self) -> NDArray[np.float64]: ...
    @position_covariance.setter
    def position_covariance(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    position_covariance_type: int
    def __init__(
        self,
        *,
        header: Header = ...,
        status: NavSatStatus = ...,
        latitude: float = ...,
        longitude: float = ...,
        altitude: float = ...,
        position_covariance: Sequence[float] | NDArray[Any] = ...,
        position_covariance_type: int = ...,
        check_fields: bool = ...,
    ) -> None: ...
