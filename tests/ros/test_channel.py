import socket
import struct
from concurrent.futures import ThreadPoolExecutor

import msgpack
import pytest

from course_lib.ros import wall
from course_lib.ros.channel import (
    MAX_FRAME,
    MOST,
    MOST_QUEUED,
    Channel,
    ChannelClosedError,
    ChannelError,
    ChannelTimeoutError,
)
from tests.patience import PATIENCE


@pytest.fixture
def ends() -> tuple[Channel, socket.socket]:
    ours, theirs = socket.socketpair()
    return Channel(ours), theirs


def framed(body: bytes) -> bytes:
    return struct.pack("!I", len(body)) + body


def test_frames_arrive_as_sent_the_queued_ones_first(ends: tuple[Channel, socket.socket]) -> None:
    channel, other = ends[0], Channel(ends[1])
    channel.queue(["first", 1])
    channel.send(["second", b"\x00", None, [1.5]])
    assert [other.receive(), other.receive()] == [["first", 1], ["second", b"\x00", None, [1.5]]]


@pytest.mark.parametrize("size", [1, 2**14])
def test_queued_frames_are_sent_before_they_take_much_memory(
    ends: tuple[Channel, socket.socket], size: int
) -> None:
    channel, other = ends[0], Channel(ends[1])
    frames = [["frame", b"x" * size]] * min(MOST_QUEUED, MOST // size)
    with ThreadPoolExecutor(1) as pool:
        came = pool.submit(lambda: [other.receive() for _ in frames])
        for frame in frames:
            channel.queue(frame)
        assert came.result(PATIENCE) == frames


@pytest.mark.parametrize(
    ("sent", "complaint"),
    [
        (struct.pack("!I", MAX_FRAME + 1), "bytes came; at most"),
        (framed(b"\xc1"), "What came is not a frame"),
        (framed(msgpack.packb({"a": 1})), "not a list that starts with its name"),
        (framed(msgpack.packb([])), "not a list that starts with its name"),
        (framed(msgpack.packb([1])), "not a list that starts with its name"),
        (framed(b"\x91" * 5000), "What came is not a frame"),
    ],
)
def test_what_is_no_frame_is_refused(
    ends: tuple[Channel, socket.socket], sent: bytes, complaint: str
) -> None:
    ends[1].sendall(sent)
    with pytest.raises(ChannelError, match=complaint):
        ends[0].receive()


def test_a_silent_or_deaf_other_side_costs_no_more_than_the_deadline(
    ends: tuple[Channel, socket.socket],
) -> None:
    channel, start = ends[0], wall.monotonic()
    channel.deadline = start + 0.05
    with pytest.raises(ChannelTimeoutError):
        channel.receive()
    with pytest.raises(ChannelTimeoutError):
        channel.send(["late"])
    channel.deadline = wall.monotonic() + 0.05
    with pytest.raises(ChannelTimeoutError):
        channel.send(["much", bytes(2**24)])
    assert wall.monotonic() - start < 60  # [s]; without it, for ever


def test_a_side_that_is_gone_is_named(ends: tuple[Channel, socket.socket]) -> None:
    ends[1].sendall(b"\x00\x00")
    ends[1].close()
    with pytest.raises(ChannelClosedError, match="is gone"):
        ends[0].receive()
    with pytest.raises(ChannelClosedError, match="is gone"):
        ends[0].send(["hello"])
