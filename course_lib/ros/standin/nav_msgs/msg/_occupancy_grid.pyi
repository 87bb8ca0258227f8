# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
from nav_msgs.msg._map_meta_data import MapMetaData
from std_msgs.msg._header import Header

class OccupancyGrid(Message):
    header: Header
    info: MapMetaData
    @property
    def data(self) -> array[int]: ...
    @data.setter
    def data(self, value: Sequence[int] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        header: Header = ...,
        info: MapMetaData = ...,
        data: Sequence[int] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...
