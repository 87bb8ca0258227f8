"""Length-prefixed msgpack frames between two processes; the other side is not trusted."""

import socket
import struct
from collections.abc import Callable
from typing import Any, TypeVar

import msgpack

from course_lib.errors import CourseError
from course_lib.ros import wall

MAX_FRAME = 32 * 2**20  # [B]
MAX_ITEMS = 1_000_000  # of all lists and dicts in a frame: an empty one is 1 byte there, and 60 here
READ, MOST = 2**14, 2**20  # [B] that are read or queued at a time: of small frames several at once
MOST_QUEUED = 256  # frames: a loop without an end is noticed at the other side, too
TELL_AGAIN = 0.02  # [s] of the wall clock
_HEADER = struct.Struct("!I")
T = TypeVar("T")
R = TypeVar("R")


class ChannelError(CourseError):
    """The other side broke the protocol."""


class FrameSizeError(ChannelError):
    """The other side sent a frame above the limit."""


class ChannelClosedError(ChannelError):
    """The other side is gone."""


class ChannelTimeoutError(ChannelError):
    """The other side did not answer in time."""


class Channel:
    """One end of a socket pair; owns `connection`, a connected stream socket, from here on."""

    def __init__(self, connection: socket.socket) -> None:
        self._socket = connection
        self._socket.settimeout(None)
        self.deadline: float | None = None  # [s] of the wall's monotonic clock
        self.overtime: Callable[[], float] = lambda: 0.0  # [s] that a deadline moves when met
        self._set: tuple[float | None, float] = (None, 0.0)  # the socket's deadline, and since when
        self._unsent: list[bytes] = []
        self._unsent_bytes = 0
        self._came = bytearray()  # behind the last frame

    def queue(self, frame: list[Any]) -> None:
        """Keep a frame that needs no answer until the next `send`, or until many wait."""
        self._pack(frame)
        if len(self._unsent) >= MOST_QUEUED or self._unsent_bytes >= MOST:
            self._send_all()

    def send(self, frame: list[Any]) -> None:
        """Send a frame, behind the queued ones; raises a ChannelError if it is not taken in time."""
        self._pack(frame)
        self._send_all()

    def receive(self) -> list[Any]:
        """Receive the next frame; raises a ChannelError if none comes in time, or it is malformed."""
        (size,) = _HEADER.unpack(self._taken(_HEADER.size))
        if size > MAX_FRAME:
            raise FrameSizeError(f"A frame of {size} bytes came; at most {MAX_FRAME} are taken.")
        body = self._taken(size)
        try:
            count = _Count()
            frame = msgpack.unpackb(
                body, raw=False, strict_map_key=True, list_hook=count.add, object_hook=count.add
            )
        except (ValueError, msgpack.UnpackException, RecursionError) as error:
            raise ChannelError(f"What came is not a frame: {error}") from error
        if not isinstance(frame, list) or not frame or not isinstance(frame[0], str):
            raise ChannelError("What came is not a list that starts with its name.")
        return frame

    def close(self) -> None:
        """Close this end."""
        self._socket.close()

    def _pack(self, frame: list[Any]) -> None:
        body = msgpack.packb(frame, use_bin_type=True)
        self._unsent.append(_HEADER.pack(len(body)) + body)
        self._unsent_bytes += len(body)

    def _send_all(self) -> None:
        data, self._unsent, self._unsent_bytes = b"".join(self._unsent), [], 0
        self._do(self._socket.sendall, data)

    def _taken(self, size: int) -> bytes:
        """Remove and return the next bytes, after waiting for so many."""
        while len(self._came) < size:
            try:
                chunk = self._do(self._socket.recv, max(READ, min(size - len(self._came), MOST)))
            except ChannelTimeoutError:
                if self._is_in_overtime():
                    continue
                raise
            if not chunk:
                raise ChannelClosedError("The other process is gone.")
            self._came += chunk
        taken = bytes(self._came[:size])
        del self._came[:size]
        return taken

    def _do(self, action: Callable[[T], R], argument: T) -> R:
        """Send or receive until the deadline, which the socket is told so often that it is kept to 20 ms."""
        try:
            if self.deadline is not None or self._set[0] is not None:
                self._keep_deadline()
            return action(argument)
        except TimeoutError as error:
            raise ChannelTimeoutError("The other process did not answer in time.") from error
        except OSError as error:
            raise ChannelClosedError("The other process is gone.") from error

    def _is_in_overtime(self) -> bool:
        self.deadline = (self.deadline or 0.0) + self.overtime()
        return self.deadline > wall.monotonic()

    def _keep_deadline(self) -> None:
        now, (known, since) = wall.monotonic(), self._set
        if self.deadline is not None and self.deadline <= now and not self._is_in_overtime():
            raise TimeoutError
        if self.deadline != known or now - since > TELL_AGAIN:
            self._socket.settimeout(None if self.deadline is None else self.deadline - now)
            self._set = self.deadline, now


class _Count:
    """A count of the items of a frame while it is unpacked."""

    def __init__(self) -> None:
        self._left = MAX_ITEMS

    def add(self, items: Any) -> Any:
        """Count the items of one more list or dict, and it."""
        self._left -= len(items) + 1
        if self._left < 0:
            raise ValueError(f"more than {MAX_ITEMS} items")
        return items
