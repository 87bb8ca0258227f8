"""Transforms between frames, their arithmetic, the buffer core, and the exceptions of tf2."""

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, field
from math import acos, inf, isnan, sin, sqrt
from operator import attrgetter
from typing import Any, NamedTuple, NoReturn, TypeAlias

import numpy as np

from course_lib.arrays import Floats, Vector

Quaternion: TypeAlias = tuple[float, float, float, float]  # (x, y, z, w)
Pose: TypeAlias = tuple[Vector, Quaternion]

IDENTITY: Pose = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


class TransformException(Exception):  # noqa: N818 - ROS's name
    """Base class of tf2's exceptions."""


class ConnectivityException(TransformException):
    """Two frames are not in the same tree."""


class LookupException(TransformException):
    """A frame does not exist, or the tree has a loop."""


class ExtrapolationException(TransformException):
    """There is no data at the requested time."""


class InvalidArgumentException(TransformException):
    """A frame name is not valid in tf2."""


class TimeoutException(TransformException):
    """A transform did not arrive in time."""


for _error in (TransformException, *TransformException.__subclasses__()):
    _error.__module__ = "tf2"


class Transform(NamedTuple):
    """The transform from a child frame to its parent frame.

    The stamp is in [ns], the translation in [m], the rotation a quaternion (x, y, z, w).
    """

    parent: str
    child: str
    stamp_ns: int
    translation: Vector
    rotation: Quaternion

    @classmethod
    def from_message(cls, message: Any) -> "Transform":
        """Create a transform from a geometry_msgs/msg/TransformStamped."""
        header, child = message.header, message.child_frame_id
        v, q = message.transform.translation, message.transform.rotation
        stamp_ns = int(header.stamp.sec) * 1_000_000_000 + int(header.stamp.nanosec)
        return cls(header.frame_id, child, stamp_ns, (v.x, v.y, v.z), (q.x, q.y, q.z, q.w))

    @property
    def pose(self) -> Pose:
        """The translation and the rotation."""
        return self.translation, self.rotation

    def matrix(self) -> Floats:
        """Return the transformation matrix from child to parent, shape (4, 4)."""
        x, y, z, w = self.rotation
        px, py, pz = self.translation
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), px],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), py],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), pz],
                [0.0, 0.0, 0.0, 1.0],
            ]
        )


def interpolate(older: Transform, newer: Transform, time_ns: int) -> Transform:
    """Interpolate between two transforms: position linearly, rotation along the shorter arc."""
    if older.stamp_ns == newer.stamp_ns:
        return newer
    ratio = (time_ns - older.stamp_ns) / (newer.stamp_ns - older.stamp_ns)
    (ax, ay, az), (bx, by, bz) = older.translation, newer.translation
    translation = (ax + ratio * (bx - ax), ay + ratio * (by - ay), az + ratio * (bz - az))
    rotation = slerp(older.rotation, newer.rotation, ratio)
    return Transform(older.parent, older.child, time_ns, translation, rotation)


def slerp(start: Quaternion, end: Quaternion, ratio: float) -> Quaternion:
    """Interpolate between two unit quaternions (x, y, z, w) along the shorter arc."""
    (ax, ay, az, aw), (bx, by, bz, bw) = start, end
    dot = ax * bx + ay * by + az * bz + aw * bw
    theta = acos(min(abs(dot), 1.0))
    if theta == 0.0:
        return start
    sin_theta = sin(theta)
    of_start = sin((1.0 - ratio) * theta) / sin_theta
    of_end = sin(ratio * theta) / sin_theta * (-1.0 if dot < 0 else 1.0)
    return (
        ax * of_start + bx * of_end,
        ay * of_start + by * of_end,
        az * of_start + bz * of_end,
        aw * of_start + bw * of_end,
    )


def compose(outer: Pose, inner: Pose) -> Pose:
    """Return the pose that applies `inner` first, then `outer`."""
    x, y, z = _rotate(outer[1], inner[0])
    px, py, pz = outer[0]
    ax, ay, az, aw = outer[1]
    bx, by, bz, bw = inner[1]
    rotation = (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )
    return (x + px, y + py, z + pz), rotation


def invert(pose: Pose) -> Pose:
    """Return the inverse of a pose with a unit quaternion."""
    (px, py, pz), (x, y, z, w) = pose
    inverse_rotation = (-x, -y, -z, w)
    return _rotate(inverse_rotation, (-px, -py, -pz)), inverse_rotation


def normalized(rotation: Quaternion) -> Quaternion:
    """Return the unit quaternion (x, y, z, w), with the sign of tf2's conversion through a matrix."""
    x, y, z, w = to_unit_quaternion(rotation)
    leading = w if abs(w) > 0.5 else max((x, y, z), key=abs)
    return (-x, -y, -z, -w) if leading < 0 else (x, y, z, w)


def to_unit_quaternion(rotation: Quaternion) -> Quaternion:
    """Return the unit quaternion (x, y, z, w), or the identity for a quaternion of zeros."""
    x, y, z, w = rotation
    length = sqrt(x * x + y * y + z * z + w * w)
    return (x / length, y / length, z / length, w / length) if length else IDENTITY[1]


def _rotate(rotation: Quaternion, point: Vector) -> Vector:
    x, y, z, w = rotation
    px, py, pz = point
    tx, ty, tz = 2 * (y * pz - z * py), 2 * (z * px - x * pz), 2 * (x * py - y * px)
    return (px + w * tx + y * tz - z * ty, py + w * ty + z * tx - x * tz, pz + w * tz + x * ty - y * tx)


class NoDataError(Exception):
    """A cache has no data at the requested time. The text is the beginning of tf2's message."""


class StaticCache:
    """A single transform that is valid at any time."""

    def __init__(self, transform: Transform) -> None:
        self._transform = transform._replace(stamp_ns=0)

    def transform_at(self, time_ns: int) -> Transform:
        """Return the transform, which is valid at any time."""
        del time_ns
        return self._transform

    def latest(self) -> Transform:
        """Return the transform, with stamp 0."""
        return self._transform

    def span(self) -> tuple[int, int, int]:
        """Return the number of transforms, and the oldest and newest stamp, [ns]."""
        return 1, 0, 0


@dataclass(eq=False, repr=False)
class TimeCache:
    """The transforms within `length_ns` [ns] of the newest one."""

    length_ns: int
    # Sorted by stamp; equal stamps are in the order of arrival.
    _transforms: list[Transform] = field(default_factory=list)

    def insert(self, transform: Transform) -> bool:
        """Store a transform.

        An exact copy is stored only once. Returns False if the transform is older than the cache's
        length.
        """
        transforms = self._transforms
        oldest_ns = transforms[-1].stamp_ns - self.length_ns if transforms else 0
        while transforms and transforms[0].stamp_ns < oldest_ns:
            del transforms[0]
        if transforms and transform.stamp_ns < oldest_ns:
            return False
        end = start = self._count_up_to(transform.stamp_ns)
        while start and transforms[start - 1].stamp_ns == transform.stamp_ns:
            start -= 1
        if transform not in transforms[start:end]:
            transforms.insert(end, transform)
        return True

    def transform_at(self, time_ns: int) -> Transform:
        """Return the transform at a time, interpolated. The time 0 means the latest transform.

        Raises:
            NoDataError: The time is outside of the stored range.
        """
        transforms = self._transforms
        if not transforms:
            _raise_no_data(time_ns, transforms)
        oldest, newest = transforms[0], transforms[-1]
        if time_ns in (0, newest.stamp_ns):
            return newest
        if time_ns == oldest.stamp_ns:
            return oldest
        if not oldest.stamp_ns < time_ns < newest.stamp_ns:
            _raise_no_data(time_ns, transforms)
        index = self._count_up_to(time_ns)
        older, newer = transforms[index - 1], transforms[index]
        return interpolate(older, newer, time_ns) if older.parent == newer.parent else older

    def latest(self) -> Transform | None:
        """Return the newest transform, or None."""
        return self._transforms[-1] if self._transforms else None

    def span(self) -> tuple[int, int, int]:
        """Return the number of transforms, and the oldest and newest stamp [ns], or zeros."""
        transforms = self._transforms
        return (len(transforms), transforms[0].stamp_ns, transforms[-1].stamp_ns) if transforms else (0, 0, 0)

    def _count_up_to(self, time_ns: int) -> int:
        """Return the number of transforms that are not newer than a time."""
        return bisect_right(self._transforms, time_ns, key=attrgetter("stamp_ns"))


def _raise_no_data(time_ns: int, transforms: list[Transform]) -> NoReturn:
    """Raise the error of a lookup at a time outside of the stored range."""
    requested = format_stamp(time_ns)
    if len(transforms) < 2:
        only = format_stamp(transforms[0].stamp_ns if transforms else 0)
        raise NoDataError(
            f"Lookup would require extrapolation at time {requested}, but only time {only} is in the buffer"
        )
    edges = ("future", "latest", transforms[-1]), ("past", "earliest", transforms[0])
    direction, edge, nearest = edges[time_ns < transforms[0].stamp_ns]
    raise NoDataError(
        f"Lookup would require extrapolation into the {direction}.  Requested time "
        f"{requested} but the {edge} data is at time {format_stamp(nearest.stamp_ns)}"
    )


def rejection_messages(
    transform: Transform,
    parent: str,
    child: str,
    authority: str,
) -> tuple[str, ...]:
    """Return the lines that tf2 logs if it rejects a transform.

    tf2 checks a quaternion after its conversion through a matrix, which normalizes it and turns
    zeros into NaN.
    """
    norm = sum(value * value for value in transform.rotation)
    has_direction, is_nan = 0 < norm < inf, isnan(sum(transform.translation))
    if has_direction and child and parent and parent != child and not is_nan:
        return ()
    by = f'from authority "{authority}"'
    values = normalized(transform.rotation) if has_direction else ("nan" if norm else "-nan",) * 4
    rotation = f"({' '.join(value if isinstance(value, str) else f'{value:f}' for value in values)})"
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
            is_nan or not has_direction,
            f'TF_NAN_INPUT: Ignoring transform for child_frame_id "{child}" {by} because of a nan value '
            f"in the transform {translation} {rotation}",
        ),
        (
            not has_direction,
            f'TF_DENORMALIZED_QUATERNION: Ignoring transform for child_frame_id "{child}" {by} because of '
            f"an invalid quaternion in the transform {rotation}",
        ),
    )
    return tuple(text for is_broken, text in rules if is_broken)


def format_stamp(time_ns: int) -> str:
    """Format a time in [s] as tf2 does."""
    return f"{time_ns / 1e9:.6f}"


CACHE_NS = 10_000_000_000  # [ns]
_MAX_DEPTH = 1000
# The length that a shorter history is counted with, including a static transform.
_SHORTEST_NS = 100_000


class BufferCore:
    """A buffer of transforms, with lookups between any frames.

    Keeps dynamic ones for `cache_ns`.
    """

    def __init__(self, cache_ns: int = CACHE_NS) -> None:
        self._cache_ns = cache_ns
        self._caches: dict[str, StaticCache | TimeCache] = {}
        # All frames in the order of their first occurrence.
        self._frames: dict[str, None] = {}
        self.authorities: dict[str, str] = {}
        # The last description, until the frames change: in a chain of thousands of frames, every
        # lookup can fail with it.
        self._description: str | None = None

    def set_transform(
        self, transform: Transform, authority: str = "default_authority", is_static: bool = False
    ) -> tuple[str, ...]:
        """Store a transform.

        A static transform is valid at any time. For a rejected transform, return the lines that tf2
        logs.
        """
        parent, child = transform.parent.removeprefix("/"), transform.child.removeprefix("/")
        complaints = rejection_messages(transform, parent, child, authority)
        if complaints:
            return complaints
        self._frames.setdefault(child)
        self._frames.setdefault(parent)
        rotation = normalized(transform.rotation)
        entry = Transform(parent, child, transform.stamp_ns, transform.translation, rotation)
        self._description = None
        if is_static:
            self._caches[child] = StaticCache(entry)
        else:
            cache = self._caches.get(child)
            if not isinstance(cache, TimeCache):
                cache = self._caches[child] = TimeCache(self._cache_ns)
            if not cache.insert(entry):
                return (
                    f"TF_OLD_DATA ignoring data from the past for frame {child} at time "
                    f"{format_stamp(transform.stamp_ns)} according to authority {authority}\n"
                    "Possible reasons are listed at http://wiki.ros.org/tf/Errors%20explained",
                )
        self.authorities[child] = authority
        return ()

    def lookup(self, target: str, source: str, time_ns: int = 0) -> Transform:
        """Return the transform that converts coordinates in `source` to coordinates in `target`.

        The time 0 [ns] stands for the latest time at which the whole chain is known. Raises a
        TransformException.
        """
        if target == source:
            cache = None if time_ns else self._caches.get(target)
            latest = cache.latest() if cache else None
            return Transform(target, source, latest.stamp_ns if latest else time_ns, *IDENTITY)
        self._check_frames(target_frame=target, source_frame=source)
        time_ns = time_ns or self._latest_common_time(target, source)
        translation, rotation = self._walk(target, source, time_ns)
        return Transform(target, source, time_ns, translation, normalized(rotation))

    def latest_common_time(self, target: str, source: str) -> int:
        """Return the newest time at which the whole chain is known [ns]; 0 if it is static.

        The errors are those of tf2_py's get_latest_common_time.
        """
        for frame in (target, source):
            self._check_frame(frame, "get_latest_common_time")
        if target == source:
            latest = self._caches[target].latest() if target in self._caches else None
            return latest.stamp_ns if latest else 0
        try:
            return self._latest_common_time(target, source)
        except TransformException as error:
            raise TransformException(str(error)) from None

    def is_too_old(self, target: str, source: str, time_ns: int) -> bool:
        """Return whether a time is older than all cached transforms, so that a lookup can never succeed.

        As in tf2, call it only for times at which the transform is unknown.
        """
        try:
            latest_ns = self._latest_common_time(target, source)
        except TransformException:
            return False
        return latest_ns != 0 and time_ns + self._cache_ns < latest_ns

    def lookup_full(
        self,
        target: str,
        target_ns: int,
        source: str,
        source_ns: int,
        fixed: str,
    ) -> Transform:
        """Return the transform from `source` at one time to `target` at another, via a fixed frame.

        The time 0 [ns] stands for the latest. Raises a TransformException.
        """
        self._check_frames(target_frame=target, source_frame=source, fixed_frame=fixed)
        inner, outer = self.lookup(fixed, source, source_ns), self.lookup(target, fixed, target_ns)
        translation, rotation = compose(outer.pose, inner.pose)
        return Transform(target, source, outer.stamp_ns, translation, normalized(rotation))

    def can_transform(self, target: str, source: str, time_ns: int = 0) -> str | None:
        """Return why a lookup would fail, with the text of tf2's canTransform, or None."""
        if target == source:
            return None
        return self._bad_argument(target_frame=target, source_frame=source) or _failure(
            lambda: self.lookup(target, source, time_ns)
        )

    def can_transform_full(
        self, target: str, target_ns: int, source: str, source_ns: int, fixed: str
    ) -> str | None:
        """Return why a full lookup would fail, or None."""
        return (
            self._bad_argument(target_frame=target, source_frame=source, fixed_frame=fixed)
            or _failure(lambda: self.lookup(target, fixed, target_ns))
            or _failure(lambda: self.lookup(fixed, source, source_ns))
        )

    def frames(self) -> list[str]:
        """List all frames that have occurred."""
        return list(self._frames)

    def parent(self, frame: str) -> str | None:
        """Return the latest parent of a frame, or None for a root or an unknown frame."""
        cache = self._caches.get(frame)
        latest = cache.latest() if cache else None
        return latest.parent if latest else None

    def span(self, frame: str) -> tuple[int, int, int]:
        """Return the number of a frame's transforms, and the oldest and newest stamp, [ns]."""
        return self._caches[frame].span()

    def describe_frames(self) -> str:
        """List each frame that has or had a parent, with the parent, in tf2's format."""
        if self._description is None:
            self._description = "".join(
                f"Frame {frame} exists with parent {self.parent(frame) or 'NO_PARENT'}.\n"
                for frame in self._frames
                if frame in self._caches
            )
        return self._description

    def clear(self) -> None:
        """Remove all dynamic transforms. Static transforms and frame names remain, as in tf2."""
        self._description = None
        for child, cache in self._caches.items():
            if isinstance(cache, TimeCache):
                self._caches[child] = TimeCache(self._cache_ns)

    def _check_frames(self, **arguments: str) -> None:
        for argument, name in arguments.items():
            self._check_frame(name, "lookupTransform argument ", argument)

    def _check_frame(self, name: str, function: str, argument: str = "") -> None:
        reason = _bad_name(name)
        if reason:
            where = f"passed to {function}{argument}"
            raise InvalidArgumentException(f'Invalid argument "{name}" {where} - {reason}')
        if name not in self._frames:
            raise LookupException(f'"{name}" passed to {function}{argument} does not exist. ')

    def _bad_argument(self, **arguments: str) -> str | None:
        for argument, name in arguments.items():
            reason = _bad_name(name) or (None if name in self._frames else "frame does not exist")
            if reason:
                return f'Invalid frame ID "{name}" passed to canTransform argument {argument} - {reason}'
        return None

    def _walk(self, target: str, source: str, time_ns: int) -> Pose:
        """Compose the transforms from both frames up to their common ancestor."""
        pose_source_to_top, top, source_error = self._climb(source, {target}, time_ns)
        if top == target:
            return pose_source_to_top
        pose_target_to_end, end, target_error = self._climb(target, {top, source}, time_ns)
        if end == source:
            return invert(pose_target_to_end)
        if end == top:
            return compose(invert(pose_target_to_end), pose_source_to_top)
        error = target_error or source_error
        if error:
            raise ExtrapolationException(
                f"{error}, when looking up transform from frame [{source}] to frame [{target}]"
            )
        raise _connectivity_error(target, source)

    def _climb(self, start: str, ends: set[str], time_ns: int) -> tuple[Pose, str, str | None]:
        """Follow parents from a frame to one of `ends`, a root or missing data.

        Returns the pose of the start in the last frame, that frame, and tf2's text for missing
        data.
        """
        pose, frame = IDENTITY, start
        for _ in range(_MAX_DEPTH):
            cache = self._caches.get(frame)
            if frame in ends or cache is None:
                return pose, frame, None
            try:
                step = cache.transform_at(time_ns)
            except NoDataError as error:
                return pose, frame, str(error)
            pose = compose((step.translation, step.rotation), pose)
            frame = step.parent
        raise self._loop_error()

    def _latest_common_time(self, target: str, source: str) -> int:
        """Return the newest time at which the whole chain is known [ns]; 0 if it is static."""
        from_source = self._latest_steps(source, {target})
        if from_source and from_source[-1].parent == target:
            return _earliest(from_source)
        met = {step.parent for step in from_source}
        from_target = self._latest_steps(target, met | {source})
        meeting = from_target[-1].parent if from_target else ""
        if meeting == source and meeting not in met:
            return _earliest(from_target)
        if meeting not in met:
            raise _connectivity_error(target, source)
        until = next(i for i, step in enumerate(from_source) if step.parent == meeting)
        return _earliest(from_target + from_source[: until + 1])

    def _latest_steps(self, start: str, ends: set[str]) -> list[Transform]:
        """Follow the latest parents from a frame to one of `ends` or a root."""
        steps: list[Transform] = []
        frame = start
        for _ in range(_MAX_DEPTH):
            cache = self._caches.get(frame)
            step = cache.latest() if cache else None
            if step is None:
                return steps
            steps.append(step)
            frame = step.parent
            if frame in ends:
                return steps
        raise self._loop_error()

    def _loop_error(self) -> LookupException:
        text = f"The tf tree is invalid because it contains a loop.\n{self.describe_frames()}\n"
        return LookupException(text)


def _earliest(steps: list[Transform]) -> int:
    return min((step.stamp_ns for step in steps if step.stamp_ns), default=0)


def _failure(lookup: Callable[[], Transform]) -> str | None:
    try:
        lookup()
    except TransformException as error:
        return str(error)
    return None


def _bad_name(frame: str) -> str | None:
    if not frame:
        return "in tf2 frame_ids cannot be empty"
    return "in tf2 frame_ids cannot start with a '/'" if frame.startswith("/") else None


def _connectivity_error(target: str, source: str) -> ConnectivityException:
    return ConnectivityException(
        f"Could not find a connection between '{target}' and '{source}' because they are not part "
        "of the same tree.Tf has two or more unconnected trees."
    )


def as_yaml(buffer: BufferCore) -> str:
    """Describe the frames as tf2's all_frames_as_yaml does; `[]` if there are none."""
    if not buffer.frames():
        return "[]"
    text = ""
    for frame, parent in parents(buffer).items():
        count, oldest_ns, newest_ns = buffer.span(frame)
        length_ns = newest_ns - oldest_ns
        text += (
            f"{frame}: \n"
            f"  parent: '{parent}'\n"
            f"  broadcaster: '{buffer.authorities[frame]}'\n"
            f"  rate: {count * 1e9 / max(length_ns, _SHORTEST_NS):.3f}\n"
            f"  most_recent_transform: {format_stamp(newest_ns)}\n"
            f"  oldest_transform: {format_stamp(oldest_ns)}\n"
            f"  buffer_length: {length_ns / 1e9:.3f}\n"
        )
    return text


def parents(buffer: BufferCore) -> dict[str, str]:
    """Return the latest parent of each frame that has one, in the order of first occurrence."""
    pairs = ((frame, buffer.parent(frame)) for frame in buffer.frames())
    return {frame: parent for frame, parent in pairs if parent is not None}


def chain(buffer: BufferCore, start: str, end: str) -> list[str]:
    """List the frames on the path from one frame to another frame of its tree."""
    parent_of = parents(buffer)
    # The paths from both frames to the root.
    paths = [start], [end]
    for path in paths:
        while (parent := parent_of.get(path[-1])) is not None and parent not in path:
            path.append(parent)
    meeting = next(frame for frame in paths[0] if frame in paths[1])
    up, down = (path[: path.index(meeting)] for path in paths)
    return [*up, meeting, *reversed(down)]
