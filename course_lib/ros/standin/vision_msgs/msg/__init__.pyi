# Written by `python -m tests.ros.messages.stubs`; don't edit.

from course_lib.ros.messages.message import Message
import geometry_msgs.msg
import std_msgs.msg
import vision_msgs.msg

class BoundingBox2D(Message):
    center: vision_msgs.msg.Pose2D
    size_x: float
    size_y: float
    def __init__(
        self,
        *,
        center: vision_msgs.msg.Pose2D = ...,
        size_x: float = ...,
        size_y: float = ...,
        check_fields: bool = ...,
    ) -> None: ...

class BoundingBox3D(Message):
    center: geometry_msgs.msg.Pose
    size: geometry_msgs.msg.Vector3
    def __init__(
        self,
        *,
        center: geometry_msgs.msg.Pose = ...,
        size: geometry_msgs.msg.Vector3 = ...,
        check_fields: bool = ...,
    ) -> None: ...

class BoundingBox3DArray(Message):
    header: std_msgs.msg.Header
    boxes: list[vision_msgs.msg.BoundingBox3D]
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        boxes: list[vision_msgs.msg.BoundingBox3D] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Detection2D(Message):
    header: std_msgs.msg.Header
    results: list[vision_msgs.msg.ObjectHypothesisWithPose]
    bbox: vision_msgs.msg.BoundingBox2D
    id: str
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        results: list[vision_msgs.msg.ObjectHypothesisWithPose] = ...,
        bbox: vision_msgs.msg.BoundingBox2D = ...,
        id: str = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Detection2DArray(Message):
    header: std_msgs.msg.Header
    detections: list[vision_msgs.msg.Detection2D]
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        detections: list[vision_msgs.msg.Detection2D] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Detection3D(Message):
    header: std_msgs.msg.Header
    results: list[vision_msgs.msg.ObjectHypothesisWithPose]
    bbox: vision_msgs.msg.BoundingBox3D
    id: str
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        results: list[vision_msgs.msg.ObjectHypothesisWithPose] = ...,
        bbox: vision_msgs.msg.BoundingBox3D = ...,
        id: str = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Detection3DArray(Message):
    header: std_msgs.msg.Header
    detections: list[vision_msgs.msg.Detection3D]
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        detections: list[vision_msgs.msg.Detection3D] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class ObjectHypothesis(Message):
    class_id: str
    score: float
    def __init__(self, *, class_id: str = ..., score: float = ..., check_fields: bool = ...) -> None: ...

class ObjectHypothesisWithPose(Message):
    hypothesis: vision_msgs.msg.ObjectHypothesis
    pose: geometry_msgs.msg.PoseWithCovariance
    def __init__(
        self,
        *,
        hypothesis: vision_msgs.msg.ObjectHypothesis = ...,
        pose: geometry_msgs.msg.PoseWithCovariance = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Point2D(Message):
    x: float
    y: float
    def __init__(self, *, x: float = ..., y: float = ..., check_fields: bool = ...) -> None: ...

class Pose2D(Message):
    position: vision_msgs.msg.Point2D
    theta: float
    def __init__(
        self,
        *,
        position: vision_msgs.msg.Point2D = ...,
        theta: float = ...,
        check_fields: bool = ...,
    ) -> None: ...
