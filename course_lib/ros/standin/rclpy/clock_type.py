"""The types of clocks."""

from enum import IntEnum


class ClockType(IntEnum):
    """The type of the clock that a time was read from. In the kit all of them show robot time."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3
