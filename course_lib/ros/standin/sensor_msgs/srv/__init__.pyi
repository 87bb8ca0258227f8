# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import TypeAlias

from course_lib.ros.messages.message import Message
import sensor_msgs.msg

class SetCameraInfo_Request(Message):
    camera_info: sensor_msgs.msg.CameraInfo
    def __init__(
        self,
        *,
        camera_info: sensor_msgs.msg.CameraInfo = ...,
        check_fields: bool = ...,
    ) -> None: ...

class SetCameraInfo_Response(Message):
    success: bool
    status_message: str
    def __init__(
        self,
        *,
        success: bool = ...,
        status_message: str = ...,
        check_fields: bool = ...,
    ) -> None: ...

class SetCameraInfo:
    Request: TypeAlias = SetCameraInfo_Request
    Response: TypeAlias = SetCameraInfo_Response
