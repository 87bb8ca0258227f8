"""Recordings of a scene: its changes over time, which a page can play.

A viewer records continuously, so recording must be cheap. Values are stored without a copy, because
drawables are immutable; after some seconds they are pickled and compressed in chunks; and only a
recording that is saved is converted to batches for a page. When a limit on time or memory is
reached, the oldest frames are merged into the initial scene, so that a truncated recording still
plays correctly.
"""

import math
import pickle
import sys
from collections import deque
from collections.abc import Callable, Iterator
from itertools import chain, takewhile
from typing import Any

import numpy as np

from course_lib.viewer import encoding
from course_lib.viewer.drawables import Camera
from course_lib.viewer.scene import ChangeKind, Scene

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    from backports import zstd

# Estimated bytes of a small change in Python.
_CHANGE = 500
# Size of a chunk that is compressed.
_FRAMES, _BYTES = 32, 2_000_000
# Frame size above which compression does not pay off, because large values are points without a
# pattern [bytes].
_LARGE = 1_000_000
# The compression level of zstd; level 3 takes a third longer and saves a tenth.
_LEVEL = 1


class Frame:
    """The last value of everything that changed at about the same time."""

    def __init__(self, time: float) -> None:
        self.time = time
        self.size = 0.0
        self.changes: dict[tuple[ChangeKind, str], Any] = {}

    def add(self, kind: ChangeKind, path: str, value: Any) -> int:
        """Add a change, and return an estimate of the additional bytes."""
        # A repeated change moves to the end, because changes are replayed in order.
        before = self.changes.pop((kind, path), None)
        self.changes[kind, path] = value
        size = _size(value) - (0 if before is None else _size(before))
        self.size += size
        return size

    def __getstate__(self) -> tuple[Any, ...]:
        """Return the state for pickle with all matrices in one array, which is ten times faster."""
        transform_changes = [
            change for change, value in self.changes.items() if isinstance(value, np.ndarray)
        ]
        matrices = np.array([self.changes[change] for change in transform_changes])
        return self.time, self.changes | dict.fromkeys(transform_changes), transform_changes, matrices

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        self.time, changes, transform_changes, matrices = state
        self.changes = changes | dict(zip(transform_changes, matrices, strict=True))


class _Chunk:
    """Some seconds of frames, compressed or not."""

    def __init__(self) -> None:
        self.frames = deque[Frame]()
        self.packed = b""
        self.size = 0.0

    def pack(self) -> None:
        """Compress the frames, unless that saves no space or a value cannot be pickled."""
        if self.size > _LARGE * len(self.frames):
            return
        try:
            self.packed = zstd.compress(pickle.dumps(self.frames, 5), _LEVEL)
        except (pickle.PicklingError, AttributeError, TypeError):
            # A student's class may have been redefined.
            return
        self.size = float(len(self.packed))
        self.frames.clear()

    def unpack(self) -> None:
        """Decompress the frames. Each gets an equal share of the compressed size."""
        if self.packed:
            self.frames, self.packed = _unpack(self.packed), b""
            for frame in self.frames:
                frame.size = self.size / len(self.frames)


class FrameStore:
    """Frames in the order of their times."""

    def __init__(self) -> None:
        self._chunks = deque[_Chunk]()
        self._count = 0
        # The estimated number of bytes.
        self.size = 0.0
        self.newest: Frame | None = None

    def __len__(self) -> int:
        """Return the number of frames."""
        return self._count

    @property
    def start(self) -> float:
        """The time of the oldest frame."""
        self._chunks[0].unpack()
        return self._chunks[0].frames[0].time

    def begin(self, time: float) -> None:
        """Add a frame. If the current chunk is full, it is compressed and a new one begins."""
        last = self._chunks[-1] if self._chunks else None
        if last is None or len(last.frames) >= _FRAMES or last.size >= _BYTES:
            if last is not None:
                self.size -= last.size
                last.pack()
                self.size += last.size
            self._chunks.append(_Chunk())
        self.newest = Frame(time)
        self._chunks[-1].frames.append(self.newest)
        self._count += 1

    def add(self, kind: ChangeKind, path: str, value: Any) -> None:
        """Add a change to the newest frame."""
        if self.newest is not None:
            size = self.newest.add(kind, path, value)
            self._chunks[-1].size += size
            self.size += size

    def drop_oldest(self) -> Frame:
        """Remove the oldest frame, and return it."""
        chunk = self._chunks[0]
        chunk.unpack()
        frame = chunk.frames.popleft()
        chunk.size -= frame.size
        self.size -= frame.size
        self._count -= 1
        if not chunk.frames:
            self._chunks.popleft()
        if not self._count:
            self.newest = None
        return frame

    def frames(self) -> Iterator[Frame]:
        """Iterate over the current frames, decompressing one chunk at a time."""
        chunks = [(chunk.packed, tuple(chunk.frames)) for chunk in self._chunks]
        return chain.from_iterable(frames or _unpack(data) for data, frames in chunks)


def _unpack(data: bytes) -> deque[Frame]:
    frames: deque[Frame] = pickle.loads(zstd.decompress(data))
    return frames


def _size(value: Any) -> int:
    """Estimate the size of a value in bytes by its arrays."""
    parts = vars(value).values() if hasattr(value, "__dict__") else ()
    return _CHANGE + sum(part.nbytes for part in parts if isinstance(part, np.ndarray))


# The time between two frames [s], like the batches of a page link.
INTERVAL = 1 / 40
# Properties of the scene, not of a node.
_OF_ALL = ("background", "look", "camera", "animation")


class SceneRecording:
    """The changes of a scene, with times.

    Changes beyond the limits are merged into the initial scene.

    Args:
        scene: The scene to record.
        now: Returns the time [s]; the recording restarts if it decreases.
        seconds: The duration to keep [s].
        megabytes: The maximum memory.
        interval: Changes within this time [s] form one frame.
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
        self._initial_scene = copy_of(scene)
        self._frames = FrameStore()
        # Whether the beginning was dropped.
        self.is_truncated = False
        # Returns the camera from which all of the recording is played, or None if it moves. A view
        # that is moved to the drawn objects is moved when it is shown: at the end.
        self.steady_camera: Callable[[], Camera | None] = lambda: None
        self.stop = scene.listen(self._record_change)

    @property
    def duration(self) -> float:
        """The time that can be played, [s]."""
        return max(self._now() - self._start, 0.0)

    @property
    def time(self) -> float:
        """The current time, [s]."""
        return self._now()

    def pack(
        self,
        seconds: float = math.inf,
        until: float = math.inf,
        interval: float = 0.0,
    ) -> bytes:
        """Return batches with times in [s] since the start, or only a snapshot if nothing has changed.

        Args:
            seconds: The maximum duration [s].
            until: The end, as a value of `time` [s].
            interval: Changes within this time [s] are merged, to save space.
        """
        with self.scene.lock:
            end, scene = min(self._now(), until), copy_of(self._initial_scene)
            frames = takewhile(lambda frame: frame.time <= end, self._frames.frames())
            recording_start, note = self._start, self.missing_part_notice()
            camera = self.steady_camera()
        start = max(recording_start, end - seconds)
        first = _seek(scene, frames, start if start < end else math.inf)
        if camera is not None:
            scene.camera = camera
        if first is None:
            return encoding.snapshot(scene)
        batches: list[dict[str, Any]] = [{"time": 0.0, **encoding.scene_batch(scene)}]
        paths = batches[0]["paths"]
        for frame in _thin(chain((first,), frames), interval):
            if camera is not None:
                frame.changes.pop(("camera", ""), None)
            _apply(scene, frame)
            batches.append({"time": frame.time - start, **_batch(scene, frame)})
            if batches[-1].get("paths", paths) == paths:
                batches[-1].pop("paths", None)
            else:
                paths = batches[-1]["paths"]
        return encoding.pack(
            {
                "start": start,
                "end": end - start,
                "note": note * (start == recording_start),
                "batches": batches,
            }
        )

    def scenes(self, seconds: float) -> Iterator[Scene]:
        """Yield one scene, as it was at about 20 times of the last seconds [s]."""
        with self.scene.lock:
            end, scene = self._now(), copy_of(self._initial_scene)
            frames, oldest = self._frames.frames(), self._start
        start = max(oldest, end - seconds)
        first = _seek(scene, frames, start if start < end else math.inf)
        if first is None:
            return
        for frame in _thin(chain((first,), frames), (end - start) / 20):
            _apply(scene, frame)
            yield scene

    def missing_part_notice(self) -> str:
        """Return a notice about the missing part, or ""."""
        if not self.is_truncated:
            return ""
        return f"Only the last {self.duration:.0f} s are included, to keep the file small."

    def _record_change(self, kind: ChangeKind, path: str) -> None:
        """Record a change. The caller holds the scene's lock."""
        now = self._now()
        newest = self._frames.newest
        if now < (newest.time if newest else self._start):
            self._merge_oldest(len(self._frames))
            self._start, newest = now, None
        if newest is None or now - newest.time >= self._interval:
            self._frames.begin(now)
        if kind in _OF_ALL:
            value = getattr(self.scene, kind)
        else:
            node = self.scene.find(path)
            value = getattr(node, _ATTRIBUTES[kind]) if node and kind in _ATTRIBUTES else None
        self._frames.add(kind, path, value)
        seconds, size = self._limits
        while len(self._frames) > 1 and (now - self._start > seconds or self._frames.size > size):
            self._merge_oldest(1)
            self._start, self.is_truncated = self._frames.start, True

    def _merge_oldest(self, count: int) -> None:
        """Merge the oldest frames into the initial scene."""
        for _ in range(count):
            _apply(self._initial_scene, self._frames.drop_oldest())


def _apply(scene: Scene, frame: Frame) -> None:
    """Apply the changes of a frame to a scene."""
    for (kind, path), value in frame.changes.items():
        if kind == "delete":
            scene.delete(path)
        elif kind in _OF_ALL:
            setattr(scene, kind, value)
        else:
            getattr(scene, f"set_{kind}")(path, value)


def _seek(scene: Scene, frames: Iterator[Frame], start: float) -> Frame | None:
    """Apply the frames before a time, [s], and return the first one after it."""
    for frame in frames:
        if frame.time >= start:
            return frame
        _apply(scene, frame)
    return None


def _thin(frames: Iterator[Frame], interval: float) -> Iterator[Frame]:
    """Yield frames at least an interval [s] apart; each contains all changes until the next one."""
    thinned: Frame | None = None
    for frame in frames:
        if thinned is None or frame.time - thinned.time >= interval:
            if thinned is not None:
                yield thinned
            thinned = Frame(frame.time)
        for (kind, path), value in frame.changes.items():
            thinned.add(kind, path, value)
    if thinned is not None:
        yield thinned


def _batch(scene: Scene, frame: Frame) -> dict[str, Any]:
    """Convert a frame to a batch. The scene already has its changes."""
    changes = [change for change in frame.changes if change[0] != "transform"]
    batch: dict[str, Any] = {}
    if changes:
        batch["commands"] = [c for kind, path in changes for c in encoding.commands(scene, kind, path)]
    moved_paths = [path for kind, path in frame.changes if kind == "transform"]
    nodes = [node for path in moved_paths if (node := scene.find(path)) is not None]
    return batch | (encoding.placements(nodes) if nodes else {})


def copy_of(scene: Scene) -> Scene:
    """Return a copy of a scene."""
    copy = Scene()
    with scene.lock:
        for node in scene.nodes():
            copy.set_transform(node.path, node.matrix)
            copy.set_visible(node.path, node.is_visible)
            if node.object is not None:
                copy.set_object(node.path, node.object)
        for kind in _OF_ALL:
            setattr(copy, kind, getattr(scene, kind))
    return copy


# Attributes of a node by kind of change.
_ATTRIBUTES: dict[ChangeKind, str] = {
    "object": "object",
    "transform": "matrix",
    "visible": "is_visible",
}
