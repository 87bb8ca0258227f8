# Written by `python -m tests.ros.messages.stubs`; don't edit.

from collections.abc import Sequence
from typing import Any
from typing import Final

import numpy as np
from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
import geometry_msgs.msg
import std_msgs.msg

class Accel(Message):
    linear: geometry_msgs.msg.Vector3
    angular: geometry_msgs.msg.Vector3
    def __init__(
        self,
        *,
        linear: geometry_msgs.msg.Vector3 = ...,
        angular: geometry_msgs.msg.Vector3 = ...,
        check_fields: bool = ...,
    ) -> None: ...

class AccelStamped(Message):
    header: std_msgs.msg.Header
    accel: geometry_msgs.msg.Accel
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        accel: geometry_msgs.msg.Accel = ...,
        check_fields: bool = ...,
    ) -> None: ...

class AccelWithCovariance(Message):
    accel: geometry_msgs.msg.Accel
    @property
    def covariance(self) -> NDArray[np.float64]: ...
    @covariance.setter
    def covariance(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        accel: geometry_msgs.msg.Accel = ...,
        covariance: Sequence[float] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class AccelWithCovarianceStamped(Message):
    header: std_msgs.msg.Header
    accel: geometry_msgs.msg.AccelWithCovariance
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        accel: geometry_msgs.msg.AccelWithCovariance = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Inertia(Message):
    m: float
    com: geometry_msgs.msg.Vector3
    ixx: float
    ixy: float
    ixz: float
    iyy: float
    iyz: float
    izz: float
    def __init__(
        self,
        *,
        m: float = ...,
        com: geometry_msgs.msg.Vector3 = ...,
        ixx: float = ...,
        ixy: float = ...,
        ixz: float = ...,
        iyy: float = ...,
        iyz: float = ...,
        izz: float = ...,
        check_fields: bool = ...,
    ) -> None: ...

class InertiaStamped(Message):
    header: std_msgs.msg.Header
    inertia: geometry_msgs.msg.Inertia
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        inertia: geometry_msgs.msg.Inertia = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Point(Message):
    x: float
    y: float
    z: float
    def __init__(
        self,
        *,
        x: float = ...,
        y: float = ...,
        z: float = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Point32(Message):
    x: float
    y: float
    z: float
    def __init__(
        self,
        *,
        x: float = ...,
        y: float = ...,
        z: float = ...,
        check_fields: bool = ...,
    ) -> None: ...

class PointStamped(Message):
    header: std_msgs.msg.Header
    point: geometry_msgs.msg.Point
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        point: geometry_msgs.msg.Point = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Polygon(Message):
    points: list[geometry_msgs.msg.Point32]
    def __init__(
        self,
        *,
        points: list[geometry_msgs.msg.Point32] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class PolygonInstance(Message):
    polygon: geometry_msgs.msg.Polygon
    id: int
    def __init__(
        self,
        *,
        polygon: geometry_msgs.msg.Polygon = ...,
        id: int = ...,
        check_fields: bool = ...,
    ) -> None: ...

class PolygonInstanceStamped(Message):
    header: std_msgs.msg.Header
    polygon: geometry_msgs.msg.PolygonInstance
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        polygon: geometry_msgs.msg.PolygonInstance = ...,
        check_fields: bool = ...,
    ) -> None: ...

class PolygonStamped(Message):
    header: std_msgs.msg.Header
    polygon: geometry_msgs.msg.Polygon
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        polygon: geometry_msgs.msg.Polygon = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Pose(Message):
    position: geometry_msgs.msg.Point
    orientation: geometry_msgs.msg.Quaternion
    def __init__(
        self,
        *,
        position: geometry_msgs.msg.Point = ...,
        orientation: geometry_msgs.msg.Quaternion = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Pose2D(Message):
    x: float
    y: float
    theta: float
    def __init__(
        self,
        *,
        x: float = ...,
        y: float = ...,
        theta: float = ...,
        check_fields: bool = ...,
    ) -> None: ...

class PoseArray(Message):
    header: std_msgs.msg.Header
    poses: list[geometry_msgs.msg.Pose]
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        poses: list[geometry_msgs.msg.Pose] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class PoseStamped(Message):
    header: std_msgs.msg.Header
    pose: geometry_msgs.msg.Pose
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        pose: geometry_msgs.msg.Pose = ...,
        check_fields: bool = ...,
    ) -> None: ...

class PoseWithCovariance(Message):
    pose: geometry_msgs.msg.Pose
    @property
    def covariance(self) -> NDArray[np.float64]: ...
    @covariance.setter
    def covariance(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        pose: geometry_msgs.msg.Pose = ...,
        covariance: Sequence[float] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class PoseWithCovarianceStamped(Message):
    header: std_msgs.msg.Header
    pose: geometry_msgs.msg.PoseWithCovariance
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        pose: geometry_msgs.msg.PoseWithCovariance = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Quaternion(Message):
    X__DEFAULT: Final = 0.0
    Y__DEFAULT: Final = 0.0
    Z__DEFAULT: Final = 0.0
    W__DEFAULT: Final = 1.0
    x: float
    y: float
    z: float
    w: float
    def __init__(
        self,
        *,
        x: float = ...,
        y: float = ...,
        z: float = ...,
        w: float = ...,
        check_fields: bool = ...,
    ) -> None: ...

class QuaternionStamped(Message):
    header: std_msgs.msg.Header
    quaternion: geometry_msgs.msg.Quaternion
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        quaternion: geometry_msgs.msg.Quaternion = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Transform(Message):
    translation: geometry_msgs.msg.Vector3
    rotation: geometry_msgs.msg.Quaternion
    def __init__(
        self,
        *,
        translation: geometry_msgs.msg.Vector3 = ...,
        rotation: geometry_msgs.msg.Quaternion = ...,
        check_fields: bool = ...,
    ) -> None: ...

class TransformStamped(Message):
    header: std_msgs.msg.Header
    child_frame_id: str
    transform: geometry_msgs.msg.Transform
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        child_frame_id: str = ...,
        transform: geometry_msgs.msg.Transform = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Twist(Message):
    linear: geometry_msgs.msg.Vector3
    angular: geometry_msgs.msg.Vector3
    def __init__(
        self,
        *,
        linear: geometry_msgs.msg.Vector3 = ...,
        angular: geometry_msgs.msg.Vector3 = ...,
        check_fields: bool = ...,
    ) -> None: ...

class TwistStamped(Message):
    header: std_msgs.msg.Header
    twist: geometry_msgs.msg.Twist
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        twist: geometry_msgs.msg.Twist = ...,
        check_fields: bool = ...,
    ) -> None: ...

class TwistWithCovariance(Message):
    twist: geometry_msgs.msg.Twist
    @property
    def covariance(self) -> NDArray[np.float64]: ...
    @covariance.setter
    def covariance(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        twist: geometry_msgs.msg.Twist = ...,
        covariance: Sequence[float] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class TwistWithCovarianceStamped(Message):
    header: std_msgs.msg.Header
    twist: geometry_msgs.msg.TwistWithCovariance
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        twist: geometry_msgs.msg.TwistWithCovariance = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Vector3(Message):
    x: float
    y: float
    z: float
    def __init__(
        self,
        *,
        x: float = ...,
        y: float = ...,
        z: float = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Vector3Stamped(Message):
    header: std_msgs.msg.Header
    vector: geometry_msgs.msg.Vector3
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        vector: geometry_msgs.msg.Vector3 = ...,
        check_fields: bool = ...,
    ) -> None: ...

class VelocityStamped(Message):
    header: std_msgs.msg.Header
    body_frame_id: str
    reference_frame_id: str
    velocity: geometry_msgs.msg.Twist
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        body_frame_id: str = ...,
        reference_frame_id: str = ...,
        velocity: geometry_msgs.msg.Twist = ...,
        check_fields: bool = ...,
    ) -> None: ...

class Wrench(Message):
    force: geometry_msgs.msg.Vector3
    torque: geometry_msgs.msg.Vector3
    def __init__(
        self,
        *,
        force: geometry_msgs.msg.Vector3 = ...,
        torque: geometry_msgs.msg.Vector3 = ...,
        check_fields: bool = ...,
    ) -> None: ...

class WrenchStamped(Message):
    header: std_msgs.msg.Header
    wrench: geometry_msgs.msg.Wrench
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        wrench: geometry_msgs.msg.Wrench = ...,
        check_fields: bool = ...,
    ) -> None: ...
