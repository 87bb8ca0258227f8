"""The period of a node's work."""

import math

from course_lib.errors import CourseError


def period_of(rate: float) -> float:
    """Return the period [s] of a rate [Hz]; raises a CourseError unless that is above 0."""
    if not 0 < rate < math.inf:
        raise CourseError(f"The rate is {rate!r}, expected one above 0, [Hz].")
    return 1.0 / rate
