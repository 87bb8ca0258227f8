# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._point import Point
from std_msgs.msg._header import Header

class GridCells(Message):
    header: Header
    cell_width: float
    cell_height: float
    cells: list[Point]
    def __init__(
        self,
        *,
        header: Header = ...,
        cell_width: float = ...,
        cell_height: float = ...,
        cells: list[Point] = ...,
        check_fields: bool = ...,
    ) -> None: ...
