# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._point import Point
from shape_msgs.msg._mesh_triangle import MeshTriangle

class Mesh(Message):
    triangles: list[MeshTriangle]
    vertices: list[Point]
    def __init__(
        self,
        *,
        triangles: list[MeshTriangle] = ...,
        vertices: list[Point] = ...,
        check_fields: bool = ...,
    ) -> None: ...
