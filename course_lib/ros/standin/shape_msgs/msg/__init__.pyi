# Written by `python -m tests.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any
from typing import Final

import numpy as np
from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
import geometry_msgs.msg
import shape_msgs.msg

class Mesh(Message):
    triangles: list[shape_msgs.msg.MeshTriangle]
    vertices: list[geometry_msgs.msg.Point]
    def __init__(
        self,
        *,
        triangles: list[shape_msgs.msg.MeshTriangle] = ...,
        vertices: list[geometry_msgs.msg.Point] = ...,
        check_fields: bool = ...,
    ) -> None: ...

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

class Plane(Message):
    @property
    def coef(self) -> NDArray[np.float64]: ...
    @coef.setter
    def coef(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    def __init__(self, *, coef: Sequence[float] | NDArray[Any] = ..., check_fields: bool = ...) -> None: ...

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
    polygon: geometry_msgs.msg.Polygon
    def __init__(
        self,
        *,
        type: int = ...,
        dimensions: Sequence[float] | NDArray[Any] = ...,
        polygon: geometry_msgs.msg.Polygon = ...,
        check_fields: bool = ...,
    ) -> None: ...
