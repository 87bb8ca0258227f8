"""The frames of a film: the newest as they are, the others packed."""

import pickle
import sys
from collections import deque
from collections.abc import Iterator
from itertools import chain
from typing import Any

import numpy as np

from course_lib.viewer.scene import What

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    from backports import zstd

_CHANGE = 500  # bytes that Python keeps for a small change, about
_FRAMES, _BYTES = 32, 2_000_000  # that a roll is packed with
_LARGE = 1_000_000  # [bytes] a frame; larger ones are points without pattern, which take long to pack
_LEVEL = 1  # of zstd: 3 takes a third longer for a tenth less


class Frame:
    """The last value of everything that changed at about one time."""

    def __init__(self, time: float) -> None:
        self.time = time
        self.size = 0.0  # [bytes]
        self.changes: dict[tuple[What, str], Any] = {}

    def add(self, what: What, path: str, value: Any) -> int:
        """Add a change; returns an estimate of the additional bytes."""
        before = self.changes.pop((what, path), None)  # the order of the last changes counts
        self.changes[what, path] = value
        size = _size(value) - (0 if before is None else _size(before))
        self.size += size
        return size

    def __getstate__(self) -> tuple[Any, ...]:
        """Return the state for pickle, matrices as one array: one by one they take ten times as long."""
        moved = [change for change, value in self.changes.items() if isinstance(value, np.ndarray)]
        matrices = np.array([self.changes[change] for change in moved])
        return self.time, self.changes | dict.fromkeys(moved), moved, matrices

    def __setstate__(self, state: tuple[Any, ...]) -> None:
        self.time, changes, moved, matrices = state
        self.changes = changes | dict(zip(moved, matrices, strict=True))


class _Roll:
    """Some seconds of frames, packed or not."""

    def __init__(self) -> None:
        self.frames = deque[Frame]()
        self.packed = b""
        self.size = 0.0  # [bytes]

    def pack(self) -> None:
        """Pack the frames, unless that is no gain, or a value is of a class that cannot be packed."""
        if self.size > _LARGE * len(self.frames):
            return
        try:
            self.packed = zstd.compress(pickle.dumps(self.frames, 5), _LEVEL)
        except (
            pickle.PicklingError,
            AttributeError,
            TypeError,
        ):  # a student's class, which was defined again
            return
        self.size = float(len(self.packed))
        self.frames.clear()

    def unpack(self) -> None:
        """Hold the frames again; their sizes add up to what they took as they were packed."""
        if self.packed:
            self.frames, self.packed = _unpacked(self.packed), b""
            for frame in self.frames:
                frame.size = self.size / len(self.frames)


class Reel:
    """Frames in the order of their times."""

    def __init__(self) -> None:
        self._rolls = deque[_Roll]()
        self._count = 0
        self.size = 0.0  # [bytes], about
        self.newest: Frame | None = None

    def __len__(self) -> int:
        """Return the number of frames."""
        return self._count

    @property
    def start(self) -> float:
        """The time of the oldest frame."""
        self._rolls[0].unpack()
        return self._rolls[0].frames[0].time

    def begin(self, time: float) -> None:
        """Add a frame; the roll before it is packed if it is full."""
        last = self._rolls[-1] if self._rolls else None
        if last is None or len(last.frames) >= _FRAMES or last.size >= _BYTES:
            if last is not None:
                self.size -= last.size
                last.pack()
                self.size += last.size
            self._rolls.append(_Roll())
        self.newest = Frame(time)
        self._rolls[-1].frames.append(self.newest)
        self._count += 1

    def add(self, what: What, path: str, value: Any) -> None:
        """Add a change to the newest frame."""
        if self.newest is not None:
            size = self.newest.add(what, path, value)
            self._rolls[-1].size += size
            self.size += size

    def forget(self) -> Frame:
        """Remove the oldest frame, and return it."""
        roll = self._rolls[0]
        roll.unpack()
        frame = roll.frames.popleft()
        roll.size -= frame.size
        self.size -= frame.size
        self._count -= 1
        if not roll.frames:
            self._rolls.popleft()
        if not self._count:
            self.newest = None
        return frame

    def frames(self) -> Iterator[Frame]:
        """Iterate over the frames that there are now, later ones left out; a roll at a time is unpacked."""
        rolls = [(roll.packed, tuple(roll.frames)) for roll in self._rolls]
        return chain.from_iterable(frames or _unpacked(packed) for packed, frames in rolls)


def _unpacked(packed: bytes) -> deque[Frame]:
    frames: deque[Frame] = pickle.loads(zstd.decompress(packed))
    return frames


def _size(value: Any) -> int:
    """Estimate the bytes of a value, by its arrays."""
    parts = vars(value).values() if hasattr(value, "__dict__") else ()
    return _CHANGE + sum(part.nbytes for part in parts if isinstance(part, np.ndarray))
