"""The changes of a scene over time, to be played again."""

import math
from collections import deque
from collections.abc import Callable
from typing import Any

import numpy as np

from course_lib.viewer import encoding
from course_lib.viewer.scene import Scene, What

INTERVAL = 1 / 40  # [s] as between a stream's batches
_CHANGE = 500  # bytes that Python keeps for a small change, about
_OF_ALL = ("background", "camera", "animation")  # what belongs to the scene, not to one node


class Film:
    """The changes of a scene, with times.

    Values are kept as they were set, and written down only when somebody wants them. What is older than the
    limits is folded into the first picture.

    Args:
        scene: What to follow.
        now: Says the time, [s]; the film restarts when it runs backwards.
        seconds: How much time is kept, [s].
        megabytes: How much memory may be used.
        interval: Changes within so many [s] are one frame.
    """

    def __init__(
        self,
        scene: Scene,
        now: Callable[[], float],
        seconds: float = 120.0,
        megabytes: float = 50.0,
        interval: float = INTERVAL,
    ) -> None:
        self.scene = scene
        self._now = now
        self._limits, self._interval = (seconds, megabytes * 1e6), interval
        self._start = now()
        self._first = copied(scene)
        self._frames: deque[_Frame] = deque()
        self._size = 0
        self.forgotten = False  # whether the beginning is gone
        self.stop = scene.listen(self._note)

    @property
    def duration(self) -> float:
        """The time that can be played, [s]."""
        return max(self._now() - self._start, 0.0)

    @property
    def time(self) -> float:
        """The present time, [s]."""
        return self._now()

    def packed(self, seconds: float = math.inf, until: float = math.inf, interval: float = 0.0) -> bytes:
        """Write batches with times in [s] since the start, or just the scene if nothing has changed.

        Args:
            seconds: How much of the past is wanted at most, [s].
            until: When that ends, as `time` was then, [s].
            interval: Changes within so many [s] become one, to save room.
        """
        with self.scene.lock:
            end = min(self._now(), until)
            frames = [frame for frame in self._frames if frame.time <= end]
            scene = copied(self._first)
        start = max(self._start, end - seconds)
        note = self.note() if start == self._start else ""
        while frames and (frames[0].time < start or end <= start):
            frames.pop(0).apply(scene)
        if not frames:
            return encoding.snapshot(scene)
        frames = _thinned(frames, interval)
        batches: list[dict[str, Any]] = [{"time": 0.0, **encoding.whole(scene)}]
        paths = batches[0]["paths"]
        for frame in frames:
            frame.apply(scene)
            batches.append({"time": frame.time - start, **_batch(scene, frame)})
            if batches[-1].get("paths", paths) == paths:
                batches[-1].pop("paths", None)
            else:
                paths = batches[-1]["paths"]
        return encoding.pack({"start": start, "end": end - start, "note": note, "batches": batches})

    def note(self) -> str:
        """The text about parts that are missing, or ""."""
        if not self.forgotten:
            return ""
        return f"It plays the last {self.duration:.0f} s; what was before took too much room."

    def _note(self, what: What, path: str) -> None:
        """Remember a change; the scene's lock is held."""
        now = self._now()
        if now < (self._frames[-1].time if self._frames else self._start):
            self._forget(len(self._frames), now)
        if not self._frames or now - self._frames[-1].time >= self._interval:
            self._frames.append(_Frame(now))
        self._size += self._frames[-1].add(what, path, _value(self.scene, what, path))
        seconds, size = self._limits
        while len(self._frames) > 1 and (now - self._start > seconds or self._size > size):
            self._forget(1, self._frames[1].time)
            self.forgotten = True

    def _forget(self, count: int, start: float) -> None:
        """Fold the oldest frames into the first picture."""
        for _ in range(count):
            frame = self._frames.popleft()
            self._size -= frame.size
            frame.apply(self._first)
        self._start = start


class _Frame:
    """The last value of everything that changed at about one time."""

    def __init__(self, time: float) -> None:
        self.time = time
        self.size = 0
        self.changes: dict[tuple[What, str], Any] = {}

    def add(self, what: What, path: str, value: Any) -> int:
        """Add a change; returns an estimate of the additional bytes."""
        before = self.changes.pop((what, path), None)  # the order of the last changes counts
        self.changes[what, path] = value
        size = _size(value) - (0 if before is None else _size(before))
        self.size += size
        return size

    def apply(self, scene: Scene) -> None:
        for (what, path), value in self.changes.items():
            _write(scene, what, path, value)


def _thinned(frames: list[_Frame], interval: float) -> list[_Frame]:
    """Return frames that are at least an interval apart; each has all changes until the next one."""
    thinned: list[_Frame] = []
    for frame in frames:
        if not thinned or frame.time - thinned[-1].time >= interval:
            thinned.append(_Frame(frame.time))
        for (what, path), value in frame.changes.items():
            thinned[-1].add(what, path, value)
    return thinned


def _batch(scene: Scene, frame: _Frame) -> dict[str, Any]:
    """Write a frame whose changes the scene has."""
    changes = [change for change in frame.changes if change[0] != "transform"]
    batch: dict[str, Any] = {}
    if changes:
        batch["commands"] = [c for what, path in changes for c in encoding.commands(scene, what, path)]
    moved = [path for what, path in frame.changes if what == "transform"]
    nodes = [node for path in moved if (node := scene.find(path)) is not None]
    return batch | (encoding.placements(nodes) if nodes else {})


def copied(scene: Scene) -> Scene:
    """Return a scene of its own with the same content."""
    copy = Scene()
    with scene.lock:
        for node in scene.nodes():
            copy.set_transform(node.path, node.matrix)
            copy.set_visible(node.path, node.visible)
            if node.object is not None:
                copy.set_object(node.path, node.object)
        for what in _OF_ALL:
            setattr(copy, what, getattr(scene, what))
    return copy


def _value(scene: Scene, what: What, path: str) -> Any:
    if what in _OF_ALL:
        return getattr(scene, what)
    node = scene.find(path)
    return node and getattr(node, {"transform": "matrix"}.get(what, what), None)


def _write(scene: Scene, what: What, path: str, value: Any) -> None:
    if what == "delete":
        scene.delete(path)
    elif what in _OF_ALL:
        setattr(scene, what, value)
    else:
        getattr(scene, f"set_{what}")(path, value)


def _size(value: Any) -> int:
    """Estimate the bytes of a value, by its arrays."""
    parts = vars(value).values() if hasattr(value, "__dict__") else ()
    return _CHANGE + sum(part.nbytes for part in parts if isinstance(part, np.ndarray))
