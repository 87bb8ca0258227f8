"""tf2's buffer: a tree of frames over time (geometry2, tf2/src/buffer_core.cpp, Jazzy)."""

from collections.abc import Callable

from course_lib.ros.tf2_cache import NoDataError, StaticCache, TimeCache, complaints_about, seconds
from course_lib.ros.tf2_transform import (
    IDENTITY,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    Pose,
    Transform,
    TransformException,
    compose,
    inverted,
    normalized,
)

CACHE_NS = 10_000_000_000  # [ns]
_MAX_DEPTH = 1000
_SHORTEST_NS = 100_000  # [ns] counts as the length of a shorter history, also of a static transform


class BufferCore:
    """A buffer of transforms, dynamic ones for `cache_ns` [ns], and lookups between any two frames."""

    def __init__(self, cache_ns: int = CACHE_NS) -> None:
        self._cache_ns = cache_ns
        self._caches: dict[str, StaticCache | TimeCache] = {}
        self._frames: dict[str, None] = {}  # all frames that were ever named, in that order
        self.authorities: dict[str, str] = {}

    def set_transform(
        self, transform: Transform, authority: str = "default_authority", is_static: bool = False
    ) -> tuple[str, ...]:
        """Store a transform; a static one holds at any time. Returns what tf2 logs if it refuses it."""
        parent, child = transform.parent.removeprefix("/"), transform.child.removeprefix("/")
        complaints = complaints_about(transform, parent, child, authority)
        if complaints:
            return complaints
        self._frames.setdefault(child)
        self._frames.setdefault(parent)
        rotation = normalized(transform.rotation)
        stored = Transform(parent, child, transform.stamp_ns, transform.translation, rotation)
        if not self._store(stored, is_static):
            return (
                f"TF_OLD_DATA ignoring data from the past for frame {child} at time "
                f"{seconds(transform.stamp_ns)} according to authority {authority}\n"
                "Possible reasons are listed at http://wiki.ros.org/tf/Errors%20explained",
            )
        self.authorities[child] = authority
        return ()

    def lookup(self, target: str, source: str, time_ns: int = 0) -> Transform:
        """Return the transform that takes coordinates in `source` to coordinates in `target`.

        The time 0 [ns] means the latest at which all of the chain is known. Raises a TransformException.
        """
        if target == source:
            cache = None if time_ns else self._caches.get(target)
            latest = cache.latest() if cache else None
            return Transform(target, source, latest.stamp_ns if latest else time_ns, *IDENTITY)
        self._check_frames(target_frame=target, source_frame=source)
        time_ns = time_ns or self._latest_common_time(target, source)
        translation, rotation = self._walk(target, source, time_ns)
        return Transform(target, source, time_ns, translation, normalized(rotation))

    def lookup_full(self, target: str, target_ns: int, source: str, source_ns: int, fixed: str) -> Transform:
        """Return the transform from `source` at one time to `target` at another; `fixed` rests between them.

        The time 0 [ns] means the latest. Raises a TransformException.
        """
        self._check_frames(target_frame=target, source_frame=source, fixed_frame=fixed)
        inner, outer = self.lookup(fixed, source, source_ns), self.lookup(target, fixed, target_ns)
        translation, rotation = compose(outer.pose, inner.pose)
        return Transform(target, source, outer.stamp_ns, translation, normalized(rotation))

    def can_transform(self, target: str, source: str, time_ns: int = 0) -> str | None:
        """Return why a lookup would fail, in the words of tf2's canTransform; None if it would not."""
        if target == source:
            return None
        return self._bad_argument(target_frame=target, source_frame=source) or _failure(
            lambda: self.lookup(target, source, time_ns)
        )

    def can_transform_full(
        self, target: str, target_ns: int, source: str, source_ns: int, fixed: str
    ) -> str | None:
        """Return why a full lookup would fail; None if it would not."""
        return (
            self._bad_argument(target_frame=target, source_frame=source, fixed_frame=fixed)
            or _failure(lambda: self.lookup(target, fixed, target_ns))
            or _failure(lambda: self.lookup(fixed, source, source_ns))
        )

    def frames(self) -> list[str]:
        """List all frames that were ever named."""
        return list(self._frames)

    def parent(self, frame: str) -> str | None:
        """Return the parent that a frame had last; None for a root or an unknown frame."""
        cache = self._caches.get(frame)
        latest = cache.latest() if cache else None
        return latest.parent if latest else None

    def span(self, frame: str) -> tuple[int, int, int]:
        """Return the number of a frame's transforms, the oldest and the newest stamp, [ns]."""
        return self._caches[frame].span()

    def described(self) -> str:
        """Name each frame that has or had a parent, and the parent, in tf2's words."""
        known = (
            (frame, self.parent(frame) or "NO_PARENT") for frame in self._frames if frame in self._caches
        )
        return "".join(f"Frame {frame} exists with parent {parent}.\n" for frame, parent in known)

    def clear(self) -> None:
        """Forget all dynamic transforms; static ones and the names of frames stay, as in tf2."""
        for child, cache in self._caches.items():
            if isinstance(cache, TimeCache):
                self._caches[child] = TimeCache(self._cache_ns)

    def _store(self, transform: Transform, is_static: bool) -> bool:
        if is_static:
            self._caches[transform.child] = StaticCache(transform)
            return True
        cache = self._caches.get(transform.child)
        if not isinstance(cache, TimeCache):
            cache = self._caches[transform.child] = TimeCache(self._cache_ns)
        return cache.insert(transform)

    def _check_frames(self, **arguments: str) -> None:
        for argument, name in arguments.items():
            where = f"passed to lookupTransform argument {argument}"
            reason = _bad_name(name)
            if reason:
                raise InvalidArgumentException(f'Invalid argument "{name}" {where} - {reason}')
            if name not in self._frames:
                raise LookupException(f'"{name}" {where} does not exist. ')

    def _bad_argument(self, **arguments: str) -> str | None:
        for argument, name in arguments.items():
            reason = _bad_name(name) or (None if name in self._frames else "frame does not exist")
            if reason:
                return f'Invalid frame ID "{name}" passed to canTransform argument {argument} - {reason}'
        return None

    def _walk(self, target: str, source: str, time_ns: int) -> Pose:
        """Compose the transforms from both frames up to where their ways meet."""
        pose_source_to_top, top, source_error = self._climb(source, {target}, time_ns)
        if top == target:
            return pose_source_to_top
        pose_target_to_end, end, target_error = self._climb(target, {top, source}, time_ns)
        if end == source:
            return inverted(pose_target_to_end)
        if end == top:
            return compose(inverted(pose_target_to_end), pose_source_to_top)
        error = target_error or source_error
        if error:
            raise ExtrapolationException(
                f"{error}, when looking up transform from frame [{source}] to frame [{target}]"
            )
        raise _unconnected(target, source)

    def _climb(self, start: str, ends: set[str], time_ns: int) -> tuple[Pose, str, str | None]:
        """Follow parents from a frame until an end, a root or missing data.

        Returns the pose of the start in the last frame, that frame, and the text of tf2 for missing data.
        """
        pose, frame = IDENTITY, start
        for _ in range(_MAX_DEPTH):
            cache = self._caches.get(frame)
            if frame in ends or cache is None:
                return pose, frame, None
            try:
                step = cache.at(time_ns)
            except NoDataError as error:
                return pose, frame, str(error)
            pose = compose((step.translation, step.rotation), pose)
            frame = step.parent
        raise self._loop()

    def _latest_common_time(self, target: str, source: str) -> int:
        """Return the newest time at which the whole chain is known, [ns]; 0 if it is static."""
        from_source = self._latest_steps(source, {target})
        if from_source and from_source[-1].parent == target:
            return _earliest(from_source)
        met = {step.parent for step in from_source}
        from_target = self._latest_steps(target, met | {source})
        meeting = from_target[-1].parent if from_target else ""
        if meeting == source and meeting not in met:
            return _earliest(from_target)
        if meeting not in met:
            raise _unconnected(target, source)
        until = next(i for i, step in enumerate(from_source) if step.parent == meeting)
        return _earliest(from_target + from_source[: until + 1])

    def _latest_steps(self, start: str, ends: set[str]) -> list[Transform]:
        """Follow the latest parents from a frame until one of the ends or a root."""
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
        raise self._loop()

    def _loop(self) -> LookupException:
        text = f"The tf tree is invalid because it contains a loop.\n{self.described()}\n"
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


def _unconnected(target: str, source: str) -> ConnectivityException:
    return ConnectivityException(
        f"Could not find a connection between '{target}' and '{source}' because they are not part of the "
        "same tree.Tf has two or more unconnected trees."
    )


def as_yaml(buffer: BufferCore) -> str:
    """Describe the frames as tf2's all_frames_as_yaml does; `[]` if there is none."""
    frames = buffer.frames()
    return (
        "".join(_described(buffer, frame, parent) for frame, parent in parents(buffer).items())
        if frames
        else "[]"
    )


def parents(buffer: BufferCore) -> dict[str, str]:
    """Return the latest parent of each frame that has one, in the order in which the frames came up."""
    found = ((frame, buffer.parent(frame)) for frame in buffer.frames())
    return {frame: parent for frame, parent in found if parent is not None}


def chain(buffer: BufferCore, start: str, end: str) -> list[str]:
    """List the frames on the way from one frame to another of its tree."""
    ups = [_upwards(buffer, frame) for frame in (start, end)]
    meeting = next(frame for frame in ups[0] if frame in ups[1])
    up, down = (way[: way.index(meeting)] for way in ups)
    return [*up, meeting, *reversed(down)]


def _upwards(buffer: BufferCore, frame: str) -> list[str]:
    known, way = parents(buffer), [frame]
    while (parent := known.get(way[-1])) is not None and parent not in way:
        way.append(parent)
    return way


def _described(buffer: BufferCore, frame: str, parent: str) -> str:
    count, oldest_ns, newest_ns = buffer.span(frame)
    length_ns = newest_ns - oldest_ns
    return (
        f"{frame}: \n"
        f"  parent: '{parent}'\n"
        f"  broadcaster: '{buffer.authorities[frame]}'\n"
        f"  rate: {count * 1e9 / max(length_ns, _SHORTEST_NS):.3f}\n"
        f"  most_recent_transform: {seconds(newest_ns)}\n"
        f"  oldest_transform: {seconds(oldest_ns)}\n"
        f"  buffer_length: {length_ns / 1e9:.3f}\n"
    )
