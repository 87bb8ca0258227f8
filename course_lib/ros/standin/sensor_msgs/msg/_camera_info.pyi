# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
from sensor_msgs.msg._region_of_interest import RegionOfInterest
from std_msgs.msg._header import Header

class CameraInfo(Message):
    header: Header
    height: int
    width: int
    distortion_model: str
    @property
    def d(self) -> array[float]: ...
    @d.setter
    def d(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    @property
    def k(self) -> NDArray[np.float64]: ...
    @k.setter
    def k(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    @property
    def r(self) -> NDArray[np.float64]: ...
    @r.setter
    def r(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    @property
    def p(self) -> NDArray[np.float64]: ...
    @p.setter
    def p(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    binning_x: int
    binning_y: int
    roi: RegionOfInterest
    def __init__(
        self,
        *,
        header: Header = ...,
        height: int = ...,
        width: int = ...,
        distortion_model: str = ...,
        d: Sequence[float] | NDArray[Any] = ...,
        k: Sequence[float] | NDArray[Any] = ...,
        r: Sequence[float] | NDArray[Any] = ...,
        p: Sequence[float] | NDArray[Any] = ...,
        binning_x: int = ...,
        binning_y: int = ...,
        roi: RegionOfInterest = ...,
        check_fields: bool = ...,
    ) -> None: ...
