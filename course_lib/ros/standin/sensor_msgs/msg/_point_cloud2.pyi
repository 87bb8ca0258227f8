# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
from sensor_msgs.msg._point_field import PointField
from std_msgs.msg._header import Header

class PointCloud2(Message):
    header: Header
    height: int
    width: int
    fields: list[PointField]
    is_bigendian: bool
    point_step: int
    row_step: int
    @property
    def data(self) -> array[int]: ...
    @data.setter
    def data(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    is_dense: bool
    def __init__(
        self,
        *,
        header: Header = ...,
        height: int = ...,
        width: int = ...,
        fields: list[PointField] = ...,
        is_bigendian: bool = ...,
        point_step: int = ...,
        row_step: int = ...,
        data: Sequence[int] | NDArray[Any] = ...,
        is_dense: bool = ...,
        check_fields: bool = ...,
    ) -> None: ...
