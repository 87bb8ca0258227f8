# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from builtin_interfaces.msg._duration import Duration
from course_lib.ros.messages.message import Message
from geometry_msgs.msg._point import Point
from std_msgs.msg._color_rgba import ColorRGBA
from std_msgs.msg._header import Header

class ImageMarker(Message):
    CIRCLE: Final = 0
    LINE_STRIP: Final = 1
    LINE_LIST: Final = 2
    POLYGON: Final = 3
    POINTS: Final = 4
    ADD: Final = 0
    REMOVE: Final = 1
    header: Header
    ns: str
    id: int
    type: int
    action: int
    position: Point
    scale: float
    outline_color: ColorRGBA
    filled: int
    fill_color: ColorRGBA
    lifetime: Duration
    points: list[Point]
    outline_colors: list[ColorRGBA]
    def __init__(
        self,
        *,
        header: Header = ...,
        ns: str = ...,
        id: int = ...,
        type: int = ...,
        action: int = ...,
        position: Point = ...,
        scale: float = ...,
        outline_color: ColorRGBA = ...,
        filled: int = ...,
        fill_color: ColorRGBA = ...,
        lifetime: Duration = ...,
        points: list[Point] = ...,
        outline_colors: list[ColorRGBA] = ...,
        check_fields: bool = ...,
    ) -> None: ...
