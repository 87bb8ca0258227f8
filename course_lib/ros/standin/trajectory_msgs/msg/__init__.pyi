# Written by `python -m tests.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
import builtin_interfaces.msg
import geometry_msgs.msg
import std_msgs.msg
import trajectory_msgs.msg

class JointTrajectory(Message):
    header: std_msgs.msg.Header
    joint_names: list[str]
    points: list[trajectory_msgs.msg.JointTrajectoryPoint]
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        joint_names: list[str] = ...,
        points: list[trajectory_msgs.msg.JointTrajectoryPoint] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class JointTrajectoryPoint(Message):
    @property
    def positions(self) -> array[float]: ...
    @positions.setter
    def positions(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    @property
    def velocities(self) -> array[float]: ...
    @velocities.setter
    def velocities(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    @property
    def accelerations(self) -> array[float]: ...
    @accelerations.setter
    def accelerations(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    @property
    def effort(self) -> array[float]: ...
    @effort.setter
    def effort(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    time_from_start: builtin_interfaces.msg.Duration
    def __init__(
        self,
        *,
        positions: Sequence[float] | NDArray[Any] = ...,
        velocities: Sequence[float] | NDArray[Any] = ...,
        accelerations: Sequence[float] | NDArray[Any] = ...,
        effort: Sequence[float] | NDArray[Any] = ...,
        time_from_start: builtin_interfaces.msg.Duration = ...,
        check_fields: bool = ...,
    ) -> None: ...

class MultiDOFJointTrajectory(Message):
    header: std_msgs.msg.Header
    joint_names: list[str]
    points: list[trajectory_msgs.msg.MultiDOFJointTrajectoryPoint]
    def __init__(
        self,
        *,
        header: std_msgs.msg.Header = ...,
        joint_names: list[str] = ...,
        points: list[trajectory_msgs.msg.MultiDOFJointTrajectoryPoint] = ...,
        check_fields: bool = ...,
    ) -> None: ...

class MultiDOFJointTrajectoryPoint(Message):
    transforms: list[geometry_msgs.msg.Transform]
    velocities: list[geometry_msgs.msg.Twist]
    accelerations: list[geometry_msgs.msg.Twist]
    time_from_start: builtin_interfaces.msg.Duration
    def __init__(
        self,
        *,
        transforms: list[geometry_msgs.msg.Transform] = ...,
        velocities: list[geometry_msgs.msg.Twist] = ...,
        accelerations: list[geometry_msgs.msg.Twist] = ...,
        time_from_start: builtin_interfaces.msg.Duration = ...,
        check_fields: bool = ...,
    ) -> None: ...
