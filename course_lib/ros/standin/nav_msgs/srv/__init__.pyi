# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import Final
from typing import TypeAlias

from course_lib.ros.messages.message import Message
import geometry_msgs.msg
import nav_msgs.msg

class GetMap_Request(Message):
    def __init__(self, *, check_fields: bool = ...) -> None: ...

class GetMap_Response(Message):
    map: nav_msgs.msg.OccupancyGrid
    def __init__(self, *, map: nav_msgs.msg.OccupancyGrid = ..., check_fields: bool = ...) -> None: ...

class GetPlan_Request(Message):
    start: geometry_msgs.msg.PoseStamped
    goal: geometry_msgs.msg.PoseStamped
    tolerance: float
    def __init__(
        self,
        *,
        start: geometry_msgs.msg.PoseStamped = ...,
        goal: geometry_msgs.msg.PoseStamped = ...,
        tolerance: float = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GetPlan_Response(Message):
    plan: nav_msgs.msg.Path
    def __init__(self, *, plan: nav_msgs.msg.Path = ..., check_fields: bool = ...) -> None: ...

class LoadMap_Request(Message):
    map_url: str
    def __init__(self, *, map_url: str = ..., check_fields: bool = ...) -> None: ...

class LoadMap_Response(Message):
    RESULT_SUCCESS: Final = 0
    RESULT_MAP_DOES_NOT_EXIST: Final = 1
    RESULT_INVALID_MAP_DATA: Final = 2
    RESULT_INVALID_MAP_METADATA: Final = 3
    RESULT_UNDEFINED_FAILURE: Final = 255
    map: nav_msgs.msg.OccupancyGrid
    result: int
    def __init__(
        self,
        *,
        map: nav_msgs.msg.OccupancyGrid = ...,
        result: int = ...,
        check_fields: bool = ...,
    ) -> None: ...

class SetMap_Request(Message):
    map: nav_msgs.msg.OccupancyGrid
    initial_pose: geometry_msgs.msg.PoseWithCovarianceStamped
    def __init__(
        self,
        *,
        map: nav_msgs.msg.OccupancyGrid = ...,
        initial_pose: geometry_msgs.msg.PoseWithCovarianceStamped = ...,
        check_fields: bool = ...,
    ) -> None: ...

class SetMap_Response(Message):
    success: bool
    def __init__(self, *, success: bool = ..., check_fields: bool = ...) -> None: ...

class GetMap:
    Request: TypeAlias = GetMap_Request
    Response: TypeAlias = GetMap_Response

class GetPlan:
    Request: TypeAlias = GetPlan_Request
    Response: TypeAlias = GetPlan_Response

class LoadMap:
    Request: TypeAlias = LoadMap_Request
    Response: TypeAlias = LoadMap_Response

class SetMap:
    Request: TypeAlias = SetMap_Request
    Response: TypeAlias = SetMap_Response
