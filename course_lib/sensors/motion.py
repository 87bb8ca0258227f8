"""Ready-made motions: functions from robot time [s] to transform_object_to_world; x points ahead."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from course_lib.errors import CourseError
from course_lib.sensors.checked import Floats, check_array, check_number


def placed(x: float, y: float, z: float, yaw: float = 0.0) -> Floats:
    """Make the transform of something that stands at a point [m], turned about z by yaw [rad]."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.array([[cos, -sin, 0, x], [sin, cos, 0, y], [0, 0, 1, z], [0, 0, 0, 1]], float)


def straight(start: ArrayLike, goal: ArrayLike, speed: float) -> Callable[[float], Floats]:
    """Go from start to goal, points [m] in the world, at a speed [m/s], and back again, and so on."""
    begin, end = check_array("start [m]", start, (3,)), check_array("goal [m]", goal, (3,))
    length = float(np.linalg.norm(end - begin))
    check_number("speed [m/s]", speed, above=0)
    if length == 0:
        raise CourseError(f"start and goal are both {begin.tolist()}; give two different points.")
    yaw = float(np.arctan2(*(end - begin)[1::-1]))

    def pose(seconds: float) -> Floats:
        gone = seconds * speed % (2 * length)
        back = gone >= length
        point = begin + (end - begin) * ((2 * length - gone if back else gone) / length)
        return placed(point[0], point[1], point[2], yaw + np.pi * back)

    return pose


def circle(center: ArrayLike, radius: float, period: float) -> Callable[[float], Floats]:
    """Go round a center [m] at a radius [m], once in a period [s]; counter-clockwise, below 0 clockwise."""
    x, y, z = check_array("center [m]", center, (3,))
    check_number("radius [m]", radius, above=0)
    if check_number("period [s]", period) == 0:
        raise CourseError("period [s] is 0; give the time of one round, negative for clockwise.")

    def pose(seconds: float) -> Floats:
        angle = 2 * np.pi * seconds / period
        ahead = angle + np.copysign(np.pi / 2, period)
        return placed(x + radius * np.cos(angle), y + radius * np.sin(angle), z, ahead)

    return pose
