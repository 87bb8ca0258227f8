"""Salvage of whole messages from bags that a full disk, a crash or Ctrl+C cut off."""

import sqlite3
import struct
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

from course_lib.recording import bag_qos
from course_lib.ros.graph import Sample
from course_lib.ros.qos import Qos

_MAGIC = b"\x89MCAP0\r\n"
_SCHEMA, _CHANNEL, _MESSAGE, _CHUNK = 3, 4, 5, 6  # opcodes of MCAP (mcap.dev/spec)
_TOPICS = "SELECT id, name, type, offered_qos_profiles FROM topics"
_MESSAGES = "SELECT timestamp, topic_id, data FROM messages NOT INDEXED"  # the index may be cut off


def data_files(folder: Path) -> list[Path]:
    """List a bag's files with messages."""
    found = (path for path in folder.iterdir() if path.suffix in (".mcap", ".db3"))
    return sorted(found, key=lambda path: (len(path.name), path.name))  # bag_10 behind bag_9


def salvage(folder: Path) -> list[Sample]:
    """Read a damaged bag up to the last whole message of each file, in the order of their stamps."""
    samples: list[Sample] = []
    for path in data_files(folder):
        reader = _mcap(path.read_bytes()) if path.suffix == ".mcap" else _sqlite(path)
        with suppress(Exception):  # where the damage is, anything goes wrong
            samples.extend(reader)
    return sorted(samples, key=lambda sample: sample.stamp_ns)


def _mcap(data: bytes) -> Iterator[Sample]:
    from rosbags.rosbag2.storage_mcap import get_qos

    types: dict[int, str] = {}
    channels: dict[int, tuple[str, str, Qos]] = {}
    for opcode, content in _unpacked(data[len(_MAGIC) :]):
        if opcode == _SCHEMA:
            types[struct.unpack_from("<H", content)[0]] = _text(content, 2)[0]
        elif opcode == _CHANNEL:
            channel, schema = struct.unpack_from("<HH", content)
            topic, at = _text(content, 4)
            metadata = content[_text(content, at)[1] + 4 :]
            channels[channel] = topic, types[schema], bag_qos.from_bag(get_qos(metadata))
        elif opcode == _MESSAGE:
            channel, _, stamp_ns = struct.unpack_from("<HIQ", content)
            topic, type_name, qos = channels[channel]
            yield Sample(stamp_ns, topic, type_name, content[22:], qos, node=0)


def _unpacked(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Yield opcode and content of whole records, also within chunks and in the cut last chunk."""
    at = 0
    while at + 9 <= len(data):
        opcode, size = struct.unpack_from("<BQ", data, at)
        content = data[at + 9 : at + 9 + size]
        at += 9 + size
        if opcode == _CHUNK:
            compression, begin = _text(content, 28)
            yield from _unpacked(_decompressed(compression, content[begin + 8 :]))
        elif len(content) == size:
            yield opcode, content


def _decompressed(compression: str, data: bytes) -> bytes:
    """Decompress data whose end may be missing."""
    decompressor: Any
    if not compression:
        return data
    if compression == "lz4":
        from lz4.frame import LZ4FrameDecompressor  # type: ignore[import-untyped]  # lz4 has no types

        decompressor = LZ4FrameDecompressor()
    elif sys.version_info >= (3, 14):
        from compression.zstd import ZstdDecompressor

        decompressor = ZstdDecompressor()
    else:
        from backports.zstd import ZstdDecompressor

        decompressor = ZstdDecompressor()
    unpacked: bytes = decompressor.decompress(data)
    return unpacked


def _text(data: bytes, at: int) -> tuple[str, int]:
    """Read a string; return it and the offset behind it."""
    end = at + 4 + int(struct.unpack_from("<I", data, at)[0])
    return data[at + 4 : end].decode(), end


def _sqlite(path: Path) -> Iterator[Sample]:
    from rosbags.rosbag2.metadata import parse_qos

    database = sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True)
    database.execute("PRAGMA writable_schema = ON")  # SQLite reads less than the header promises only then
    topics = {}
    for topic, name, type_name, offered in database.execute(_TOPICS):
        topics[topic] = name, type_name, bag_qos.from_bag(parse_qos(offered))
    for stamp_ns, topic, cdr in database.execute(_MESSAGES):
        name, type_name, qos = topics[topic]
        yield Sample(stamp_ns, name, type_name, cdr, qos, node=0)
