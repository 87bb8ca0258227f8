import struct

import pytest
from hypothesis import given, settings

from tests.hostile.fuzzing import PUBLISHER, packed, streams, swallow


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(streams)
def test_arbitrary_worker_stream_gives_a_mark(stream: bytes) -> None:
    swallow(stream)


def test_fuzzed_streams_can_contain_published_messages() -> None:
    published = packed(["publish", 3, b"x"]) + packed(["result", [], []]) + packed(["exit", 0, 0.1])
    assert swallow(b"".join(map(packed, PUBLISHER)) + published).samples


@pytest.mark.parametrize(
    "stream",
    [
        struct.pack("!I", 2**31) + b"x",
        struct.pack("!I", 2**32 - 1),
        struct.pack("!I", 100_000) + b"\x91" * 100_000,
        struct.pack("!I", 150_004) + b"\xdd\x7f\xff\xff\xff" + b"\x90" * 149_999,
        packed(["result", [float("nan"), float("inf"), -0.0], []]),
        packed(["result", [[[[]]] * 1000], ["x" * 10_000]]),
        packed(["result", [{"object": 1}] * 100, []]) + packed(["exit", 0, 0.1]),
    ],
)
def test_stream_bomb_is_rejected(stream: bytes) -> None:
    swallow(stream)
