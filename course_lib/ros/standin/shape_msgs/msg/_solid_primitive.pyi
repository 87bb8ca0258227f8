# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any, Final

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._polygon import Polygon

class SolidPrimitive(Message):
    BOX: Final = 1
    SPHERE: Final = 2
    CYLINDER: Final = 3
    CONE: Final = 4
    PRISM: Final = 5
    BOX_X: Final = 0
    BOX_Y: Final = 1
    BOX_Z: Final = 2
    SPHERE_RADIUS: Final = 0
    CYLINDER_HEIGHT: Final = 0
    CYLINDER_RADIUS: Final = 1
    CONE_HEIGHT: Final = 0
    CONE_RADIUS: Final = 1
    PRISM_HEIGHT: Final = 0
    type: int
    @property
    def dimensions(self) -> array[float]: ...
    @dimensions.setter
    def dimensions(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    polygon: Polygon
    def __init__(
        self,
        *,
        type: int = ...,
        dimensions: Sequence[float] | NDArray[Any] = ...,
        polygon: Polygon = ...,
        check_fields: bool = ...,
    ) -> None: ...
