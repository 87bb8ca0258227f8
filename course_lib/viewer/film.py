"""The changes of a scene over time, to be played again."""

import math
from collections.abc import Callable, Iterator
from itertools import chain, takewhile
from typing import Any

from course_lib.viewer import encoding
from course_lib.viewer.reel import Frame, Reel
from course_lib.viewer.scene import Scene, What

INTERVAL = 1 / 40  # [s] as between a stream's batches
_OF_ALL = ("background", "camera", "animation")  # what belongs to the scene, not to one node


class Film:
    """The changes of a scene, with times.

    Values are kept as they were set, the older ones packed, and written down only when somebody wants them.
    What is older than the limits is folded into the first picture.

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
        self._frames = Reel()
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
            end, scene = min(self._now(), until), copied(self._first)
            frames = takewhile(lambda frame: frame.time <= end, self._frames.frames())
            begun, note = self._start, self.note()
        start = max(begun, end - seconds)
        first = _seek(scene, frames, start if start < end else math.inf)
        if first is None:
            return encoding.snapshot(scene)
        batches: list[dict[str, Any]] = [{"time": 0.0, **encoding.whole(scene)}]
        paths = batches[0]["paths"]
        for frame in _thinned(chain((first,), frames), interval):
            _apply(scene, frame)
            batches.append({"time": frame.time - start, **_batch(scene, frame)})
            if batches[-1].get("paths", paths) == paths:
                batches[-1].pop("paths", None)
            else:
                paths = batches[-1]["paths"]
        return encoding.pack(
            {"start": start, "end": end - start, "note": note * (start == begun), "batches": batches}
        )

    def note(self) -> str:
        """The text about parts that are missing, or ""."""
        if not self.forgotten:
            return ""
        return f"It plays the last {self.duration:.0f} s; what was before took too much room."

    def _note(self, what: What, path: str) -> None:
        """Remember a change; the scene's lock is held."""
        now = self._now()
        newest = self._frames.newest
        if now < (newest.time if newest else self._start):
            self._forget(len(self._frames))
            self._start, newest = now, None
        if newest is None or now - newest.time >= self._interval:
            self._frames.begin(now)
        self._frames.add(what, path, _value(self.scene, what, path))
        seconds, size = self._limits
        while len(self._frames) > 1 and (now - self._start > seconds or self._frames.size > size):
            self._forget(1)
            self._start, self.forgotten = self._frames.start, True

    def _forget(self, count: int) -> None:
        """Fold the oldest frames into the first picture."""
        for _ in range(count):
            _apply(self._first, self._frames.forget())


def _apply(scene: Scene, frame: Frame) -> None:
    """Change a scene as a frame says."""
    for (what, path), value in frame.changes.items():
        _write(scene, what, path, value)


def _seek(scene: Scene, frames: Iterator[Frame], start: float) -> Frame | None:
    """Apply the frames before a time, [s]; returns the first one after it."""
    for frame in frames:
        if frame.time >= start:
            return frame
        _apply(scene, frame)
    return None


def _thinned(frames: Iterator[Frame], interval: float) -> Iterator[Frame]:
    """Yield frames that are at least an interval apart, [s]; each has all changes until the next one."""
    thinned: Frame | None = None
    for frame in frames:
        if thinned is None or frame.time - thinned.time >= interval:
            if thinned is not None:
                yield thinned
            thinned = Frame(frame.time)
        for (what, path), value in frame.changes.items():
            thinned.add(what, path, value)
    if thinned is not None:
        yield thinned


def _batch(scene: Scene, frame: Frame) -> dict[str, Any]:
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
