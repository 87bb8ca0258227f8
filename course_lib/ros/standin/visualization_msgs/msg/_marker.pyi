# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from typing import Final

from builtin_interfaces.msg._duration import Duration
from course_lib.ros.messages.message import Message
from geometry_msgs.msg._point import Point
from geometry_msgs.msg._pose import Pose
from geometry_msgs.msg._vector3 import Vector3
from sensor_msgs.msg._compressed_image import CompressedImage
from std_msgs.msg._color_rgba import ColorRGBA
from std_msgs.msg._header import Header
from visualization_msgs.msg._mesh_file import MeshFile
from visualization_msgs.msg._uv_coordinate import UVCoordinate

class Marker(Message):
    ARROW: Final = 0
    CUBE: Final = 1
    SPHERE: Final = 2
    CYLINDER: Final = 3
    LINE_STRIP: Final = 4
    LINE_LIST: Final = 5
    CUBE_LIST: Final = 6
    SPHERE_LIST: Final = 7
    POINTS: Final = 8
    TEXT_VIEW_FACING: Final = 9
    MESH_RESOURCE: Final = 10
    TRIANGLE_LIST: Final = 11
    ARROW_STRIP: Final = 12
    ADD: Final = 0
    MODIFY: Final = 0
    DELETE: Final = 2
    DELETEALL: Final = 3
    header: Header
    ns: str
    id: int
    type: int
    action: int
    pose: Pose
    scale: Vector3
    color: ColorRGBA
    lifetime: Duration
    frame_locked: bool
    points: list[Point]
    colors: list[ColorRGBA]
    texture_resource: str
    texture: CompressedImage
    uv_coordinates: list[UVCoordinate]
    text: str
    mesh_resource: str
    mesh_file: MeshFile
    mesh_use_embedded_materials: bool
    def __init__(
        self,
        *,
        header: Header = ...,
        ns: str = ...,
        id: int = ...,
        type: int = ...,
        action: int = ...,
        pose: Pose = ...,
        scale: Vector3 = ...,
        color: ColorRGBA = ...,
        lifetime: Duration = ...,
        frame_locked: bool = ...,
        points: list[Point] = ...,
        colors: list[ColorRGBA] = ...,
        texture_resource: str = ...,
        texture: CompressedImage = ...,
        uv_coordinates: list[UVCoordinate] = ...,
        text: str = ...,
        mesh_resource: str = ...,
        mesh_file: MeshFile = ...,
        mesh_use_embedded_materials: bool = ...,
        check_fields: bool = ...,
    ) -> None: ...
