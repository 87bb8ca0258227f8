import socket
import struct
from concurrent.futures import ThreadPoolExecutor

import msgpack
import pytest

from course_lib.ros.graph.remote import (
    MAX_BATCH,
    MAX_FRAME,
    MAX_QUEUED,
    Channel,
    ChannelClosedError,
    ChannelError,
    ChannelTimeoutError,
)
from course_lib.ros.time import wall
from tests.patience import PATIENCE


@pytest.fixture
def ends() -> tuple[Channel, socket.socket]:
    own_end, other_end = socket.socketpair()
    return Channel(own_end), other_end


def framed(body: bytes) -> bytes:
    return struct.pack("!I", len(body)) + body


def test_frames_arrive_in_order_with_queued_frames_first(ends: tuple[Channel, socket.socket]) -> None:
    channel, other = ends[0], Channel(ends[1])
    channel.queue(["first", 1])
    channel.send(["second", b"\x00", None, [1.5]])
    assert [other.receive(), other.receive()] == [["first", 1], ["second", b"\x00", None, [1.5]]]


@pytest.mark.parametrize("size", [1, 2**14])
def test_queued_frames_are_flushed_before_they_use_much_memory(
    ends: tuple[Channel, socket.socket], size: int
) -> None:
    channel, other = ends[0], Channel(ends[1])
    frames = [["frame", b"x" * size]] * min(MAX_QUEUED, MAX_BATCH // size)
    with ThreadPoolExecutor(1) as pool:
        came = pool.submit(lambda: [other.receive() for _ in frames])
        for frame in frames:
            channel.queue(frame)
        assert came.result(PATIENCE) == frames


@pytest.mark.parametrize(
    ("sent", "complaint"),
    [
        (struct.pack("!I", MAX_FRAME + 1), "the limit is"),
        (framed(b"\xc1"), "is not a valid frame"),
        (framed(msgpack.packb({"a": 1})), "not a list that starts with its name"),
        (framed(msgpack.packb([])), "not a list that starts with its name"),
        (framed(msgpack.packb([1])), "not a list that starts with its name"),
        (framed(b"\x91" * 5000), "is not a valid frame"),
    ],
)
def test_invalid_frame_is_rejected(ends: tuple[Channel, socket.socket], sent: bytes, complaint: str) -> None:
    ends[1].sendall(sent)
    with pytest.raises(ChannelError, match=complaint):
        ends[0].receive()


def test_unresponsive_peer_delays_calls_at_most_until_the_deadline(
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


def test_closed_peer_is_reported_on_receive_and_send(ends: tuple[Channel, socket.socket]) -> None:
    ends[1].sendall(b"\x00\x00")
    ends[1].close()
    with pytest.raises(ChannelClosedError, match="has ended"):
        ends[0].receive()
    with pytest.raises(ChannelClosedError, match="has ended"):
        ends[0].send(["hello"])
