# Written by `python -m course_lib.ros.messages.stubs`; don't edit.

from array import array
from collections.abc import Sequence
from typing import Any

from numpy.typing import NDArray

from builtin_interfaces.msg._duration import Duration
from course_lib.ros.messages.message import Message

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
    time_from_start: Duration
    def __init__(
        self,
        *,
        positions: Sequence[float] | NDArray[Any] = ...,
        velocities: Sequence[float] | NDArray[Any] = ...,
        accelerations: Sequence[float] | NDArray[Any] = ...,
        effort: Sequence[float] | NDArray[Any] = ...,
        time_from_start: Duration = ...,
        check_fields: bool = ...,
    ) -> None: ...
