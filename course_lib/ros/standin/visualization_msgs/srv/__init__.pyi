# Written by `python -m tests.ros.messages.stubs`; don't edit.

from typing import TypeAlias

from course_lib.ros.messages.message import Message
import visualization_msgs.msg

class GetInteractiveMarkers_Request(Message):
    def __init__(self, *, check_fields: bool = ...) -> None: ...

class GetInteractiveMarkers_Response(Message):
    sequence_number: int
    markers: list[visualization_msgs.msg.InteractiveMarker]
    def __init__(
        self,
        *,
        sequence_number: int = ...,
        markers: list[visualization_msgs.msg.InteractiveMarker] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class GetInteractiveMarkers:
    Request: TypeAlias = GetInteractiveMarkers_Request
    Response: TypeAlias = GetInteractiveMarkers_Response
