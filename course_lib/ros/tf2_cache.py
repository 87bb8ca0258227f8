"""The transforms of one frame to its parent over time, and the transforms that tf2 refuses."""

from bisect import bisect_right
from dataclasses import replace
from math import isnan
from operator import attrgetter

from course_lib.ros.tf2_transform import Transform, interpolated

_NORM_TOLERANCE = 10e-3  # of the squared norm of a quaternion


class NoDataError(Exception):
    """A cache has nothing at the requested time; the text is the first half of tf2's."""


class StaticCache:
    """One transform that holds at any time."""

    def __init__(self, transform: Transform) -> None:
        self._transform = replace(transform, stamp_ns=0)

    def at(self, time_ns: int) -> Transform:
        """Return the transform, which holds at any time."""
        del time_ns
        return self._transform

    def latest(self) -> Transform:
        """Return the transform, stamped 0."""
        return self._transform

    def span(self) -> tuple[int, int, int]:
        """Return the number of transforms, the oldest and the newest stamp, [ns]."""
        return 1, 0, 0


class TimeCache:
    """The transforms of the last `length_ns` [ns] before the newest one."""

    def __init__(self, length_ns: int) -> None:
        self._length_ns = length_ns
        self._stored: list[Transform] = []  # by stamp; among equal stamps the last to come is last

    def insert(self, transform: Transform) -> bool:
        """Store a transform, an exact copy only once; False if it is older than the cache reaches."""
        stored = self._stored
        oldest_ns = stored[-1].stamp_ns - self._length_ns if stored else 0
        while stored and stored[0].stamp_ns < oldest_ns:
            del stored[0]
        if stored and transform.stamp_ns < oldest_ns:
            return False
        end = start = self._count_until(transform.stamp_ns)
        while start and stored[start - 1].stamp_ns == transform.stamp_ns:
            start -= 1
        if transform not in stored[start:end]:
            stored.insert(end, transform)
        return True

    def at(self, time_ns: int) -> Transform:
        """Return the transform at a time, interpolated; 0 means the latest. Raises NoDataError outside."""
        stored = self._stored
        if stored and time_ns in (0, stored[-1].stamp_ns):
            return stored[-1]
        if stored and time_ns == stored[0].stamp_ns:
            return stored[0]
        self._refuse_outside(time_ns)
        index = self._count_until(time_ns)
        older, newer = stored[index - 1], stored[index]
        return interpolated(older, newer, time_ns) if older.parent == newer.parent else older

    def latest(self) -> Transform | None:
        """Return the newest transform."""
        return self._stored[-1] if self._stored else None

    def span(self) -> tuple[int, int, int]:
        """Return the number of transforms, the oldest and the newest stamp, [ns]; stamps of none are 0."""
        stored = self._stored
        return (len(stored), stored[0].stamp_ns, stored[-1].stamp_ns) if stored else (0, 0, 0)

    def _count_until(self, time_ns: int) -> int:
        """Count the transforms that are not newer than a time."""
        return bisect_right(self._stored, time_ns, key=attrgetter("stamp_ns"))

    def _refuse_outside(self, time_ns: int) -> None:
        wanted = seconds(time_ns)
        if len(self._stored) < 2:
            only = seconds(self._stored[0].stamp_ns if self._stored else 0)
            raise NoDataError(
                f"Lookup would require extrapolation at time {wanted}, but only time {only} is in the buffer"
            )
        edges = ("future", "latest", self._stored[-1]), ("past", "earliest", self._stored[0])
        direction, edge, nearest = edges[time_ns < self._stored[0].stamp_ns]
        if not self._stored[0].stamp_ns < time_ns < self._stored[-1].stamp_ns:
            raise NoDataError(
                f"Lookup would require extrapolation into the {direction}.  Requested time {wanted} "
                f"but the {edge} data is at time {seconds(nearest.stamp_ns)}"
            )


def complaints_about(transform: Transform, parent: str, child: str, authority: str) -> tuple[str, ...]:
    """Return the lines that tf2 logs about a transform that it refuses."""
    x, y, z, w = transform.rotation
    is_unit = abs(x * x + y * y + z * z + w * w - 1.0) < _NORM_TOLERANCE
    if is_unit and child and parent and parent != child and not isnan(sum(transform.translation)):
        return ()
    by = f'from authority "{authority}"'
    rotation = f"({x:f} {y:f} {z:f} {w:f})"
    translation = "({:f} {:f} {:f})".format(*transform.translation)
    rules = (
        (
            parent == child,
            f'TF_SELF_TRANSFORM: Ignoring transform {by} with frame_id and  child_frame_id "{child}" '
            "because they are the same",
        ),
        (not child, f"TF_NO_CHILD_FRAME_ID: Ignoring transform {by} because child_frame_id not set "),
        (
            not parent,
            f'TF_NO_FRAME_ID: Ignoring transform with child_frame_id "{child}"  {by} '
            "because frame_id not set",
        ),
        (
            any(isnan(value) for value in (*transform.translation, *transform.rotation)),
            f'TF_NAN_INPUT: Ignoring transform for child_frame_id "{child}" {by} because of a nan value '
            f"in the transform {translation} {rotation}",
        ),
        (
            not is_unit,
            f'TF_DENORMALIZED_QUATERNION: Ignoring transform for child_frame_id "{child}" {by} because of '
            f"an invalid quaternion in the transform {rotation}",
        ),
    )
    return tuple(text for broken, text in rules if broken)


def seconds(time_ns: int) -> str:
    """Write a time in [s] as tf2 does."""
    return f"{time_ns / 1e9:.6f}"
