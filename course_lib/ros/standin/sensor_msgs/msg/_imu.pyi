# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from course_lib.ros.messages.message import Message
from geometry_msgs.msg._quaternion import Quaternion
from geometry_msgs.msg._vector3 import Vector3
from std_msgs.msg._header import Header

class Imu(Message):
    header: Header
    orientation: Quaternion
    @property
    def orientation_covariance(self) -> NDArray[np.float64]: ...
    @orientation_covariance.setter
    def orientation_covariance(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    angular_velocity: Vector3
    @property
    def angular_velocity_covariance(self) -> NDArray[np.float64]: ...
    @angular_velocity_covariance.setter
    def angular_velocity_covariance(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    linear_acceleration: Vector3
    @property
    def linear_acceleration_covariance(self) -> NDArray[np.float64]: ...
    @linear_acceleration_covariance.setter
    def linear_acceleration_covariance(self, value: Sequence[float] | NDArray[Any]) -> None: ...
    def __init__(
        self,
        *,
        header: Header = ...,
        orientation: Quaternion = ...,
        orientation_covariance: Sequence[float] | NDArray[Any] = ...,
        angular_velocity: Vector3 = ...,
        angular_velocity_covariance: Sequence[float] | NDArray[Any] = ...,
        linear_acceleration: Vector3 = ...,
        linear_acceleration_covariance: Sequence[float] | NDArray[Any] = ...,
        check_fields: bool = ...,
    ) -> None: ...
