"""The files of a bag: their QoS profiles, and the messages of damaged files.

rosbags reads intact bags only. Bags of students are often incomplete, because the recorder was
killed or the disk was full, so `salvage` reads the records of MCAP and SQLite itself up to the
damage.
"""

import os
import shutil
import sqlite3
import struct
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, BinaryIO

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Sample
from course_lib.ros.graph.topics import Qos
from course_lib.ros.messages.definitions import add_stored_definition
from course_lib.third_party import LFS_POINTER, NOT_FETCHED, check_regular

if TYPE_CHECKING:
    from rosbags.interfaces import Qos as BagQos
    from rosbags.interfaces import QosTime


# rmw's infinite duration [ns], which can also be given as 0.
_INFINITE = 2**63 - 1
# In nanoseconds.
SECOND_NS = 10**9


def to_bag(qos: Qos) -> "BagQos":
    """Convert a QoS profile to the representation of rosbags."""
    from rosbags import interfaces

    return interfaces.Qos(
        interfaces.QosHistory[qos.history.upper()],
        qos.depth,
        interfaces.QosReliability[qos.reliability.upper()],
        interfaces.QosDurability[qos.durability.upper()],
        _to_time(qos.deadline_ns),
        _to_time(qos.lifespan_ns),
        interfaces.QosLiveliness[qos.liveliness.upper()],
        _to_time(qos.lease_ns),
        avoid_ros_namespace_conventions=False,
    )


def from_bag(profiles: Sequence["BagQos"]) -> Qos:
    """Return the QoS of a topic's first publisher, because a bag does not store who published a message.

    System defaults are replaced by ROS's defaults.
    """
    if not profiles:
        return Qos()
    qos = profiles[0]
    return Qos(
        history="keep_all" if qos.history.name == "KEEP_ALL" else "keep_last",
        depth=qos.depth,
        reliability="best_effort" if qos.reliability.name == "BEST_EFFORT" else "reliable",
        durability="transient_local" if qos.durability.name == "TRANSIENT_LOCAL" else "volatile",
        deadline_ns=_from_time(qos.deadline),
        lifespan_ns=_from_time(qos.lifespan),
        liveliness="manual_by_topic" if qos.liveliness.name == "MANUAL_BY_TOPIC" else "automatic",
        lease_ns=_from_time(qos.liveliness_lease_duration),
    )


def _to_time(duration_ns: int | None) -> "QosTime":
    from rosbags.interfaces import QosTime

    return QosTime(*divmod(_INFINITE if duration_ns is None else duration_ns, SECOND_NS))


def _from_time(time: Any) -> int | None:
    duration_ns = time.sec * SECOND_NS + time.nsec
    return None if duration_ns in (0, _INFINITE) else int(duration_ns)


_MAGIC = b"\x89MCAP0\r\n"
_SQLITE_MAGIC = b"SQLite format 3\0"
# Opcodes of MCAP (mcap.dev/spec).
_SCHEMA, _CHANNEL, _MESSAGE, _CHUNK = _OPCODES = (3, 4, 5, 6)
_TOPICS = "SELECT id, name, type, serialization_format, offered_qos_profiles FROM topics"
_DEFINITIONS_TABLE = "SELECT 1 FROM sqlite_master WHERE name = 'message_definitions'"
_DEFINITIONS = "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions"
# The encodings of definitions in the formats of .msg and .idl files. rosbag2 writes the third one
# for services whose definitions use no other types, and where it does not find a definition.
TEXT_ENCODINGS = ("ros2msg", "ros2idl", "unknown")
# Without the index, because it may be incomplete.
_MESSAGES = "SELECT timestamp, topic_id, data FROM messages NOT INDEXED"
STORAGES = {".mcap": "mcap", ".db3": "sqlite3"}


# The name of the only serialization format that can be read, which is ROS 2's default.
CDR = "cdr"


class UnsupportedFormatError(CourseError):
    """A bag has messages in a serialization format other than CDR."""


class StampError(CourseError):
    """A message of a bag has a time that ROS cannot represent."""


def check_format(bag: Path, topic: str, serialization_format: str) -> None:
    """Raise an UnsupportedFormatError for messages that are not serialized as CDR."""
    # An incomplete bag may lack the name.
    if serialization_format not in ("", CDR):
        raise UnsupportedFormatError(
            f"The bag {bag} has messages in the serialization format '{serialization_format}', on "
            f"{topic}. Only '{CDR}' is supported: record it in that format, which is the default "
            "of ros2 bag record."
        )


def is_data_file(path: Path) -> bool:
    """Return whether a path is a file with messages of a bag."""
    return path.suffix in (".mcap", ".db3") and path.is_file()


def data_files(bag: Path) -> list[Path]:
    """List the files with messages of a bag, which may be a single file."""
    if is_data_file(bag):
        return [bag]
    paths = (path for path in bag.iterdir() if is_data_file(path))
    # By length first, so that bag_10 follows bag_9.
    return sorted(paths, key=lambda path: (len(path.name), path.name))


def salvage(files: Sequence[Path]) -> tuple[list[Sample], str]:
    """Read each file of a bag up to its last complete message.

    Returns:
        The samples sorted by stamp, and the first damage or "".

    Raises:
        CourseError: A file is a pointer of Git LFS, or is not serialized as CDR.
    """
    samples: list[Sample] = []
    damages: list[str] = []
    for path in files:
        check_regular(path)
        # The file may be larger than the memory.
        with path.open("rb") as file:
            if file.read(len(LFS_POINTER)) == LFS_POINTER:
                raise CourseError(f"{path} is not a file of a bag: {NOT_FETCHED}.")
            try:
                if damage := _find_missing_part(path, file):
                    damages.append(damage)
                file.seek(len(_MAGIC))
                samples.extend(_mcap(file, path) if path.suffix == ".mcap" else _sqlite(path))
            except UnsupportedFormatError:
                raise
            except StampError as error:
                damages.append(f"{path.name} {error}")
            # A damaged file can cause any error, whose text is about the reader and not the file.
            except Exception:
                damages.append(f"{path.name} has bytes that were changed")
    return sorted(samples, key=lambda sample: sample.stamp_ns), damages[0] if damages else ""


def _find_missing_part(path: Path, file: BinaryIO) -> str:
    """Return which part of an MCAP or SQLite file is missing, judged by its two ends, or ""."""
    size = file.seek(0, os.SEEK_END)
    if size == 0:
        return f"{path.name} is empty"
    file.seek(0)
    head = file.read(100)
    if path.suffix == ".mcap":
        file.seek(-min(len(_MAGIC), size), os.SEEK_END)
        begins, ends = head.startswith(_MAGIC), file.read() == _MAGIC
        kind = "an MCAP file"
    else:
        begins = head.startswith(_SQLITE_MAGIC) and len(head) == 100
        # The header has the size of a page, in which 1 stands for 65536, and the number of pages.
        page_size, page_count = struct.unpack_from(">H10xI", head, 16) if begins else (0, 0)
        ends = size >= (2**16 if page_size == 1 else page_size) * page_count
        kind = "a SQLite file"
    if not begins:
        return f"{path.name} does not begin as {kind} does"
    return "" if ends else f"the end of {path.name} is missing"


def _mcap(file: BinaryIO, path: Path) -> Iterator[Sample]:
    from rosbags.rosbag2.storage_mcap import get_qos

    types: dict[int, str] = {}
    channels: dict[int, tuple[str, str, Qos]] = {}
    for opcode, content in _unpack_records(file):
        if opcode == _SCHEMA:
            name, at = _text(content, 2)
            types[struct.unpack_from("<H", content)[0]] = name
            encoding, at = _text(content, at)
            if encoding in TEXT_ENCODINGS:
                add_stored_definition(name, _text(content, at)[0])
        elif opcode == _CHANNEL:
            channel, schema = struct.unpack_from("<HH", content)
            topic, at = _text(content, 4)
            encoding, at = _text(content, at)
            check_format(path, topic, encoding)
            metadata = content[at + 4 :]
            channels[channel] = topic, types[schema], from_bag(get_qos(metadata))
        elif opcode == _MESSAGE:
            channel, _, stamp_ns = struct.unpack_from("<HIQ", content)
            check_stamp(stamp_ns)
            topic, type_name, qos = channels[channel]
            yield Sample(stamp_ns, topic, type_name, content[22:], qos, node=0)


def _unpack_records(file: BinaryIO) -> Iterator[tuple[int, bytes]]:
    """Yield opcode and content of complete records, also within chunks and an incomplete last one."""
    at = file.tell()
    length = file.seek(0, os.SEEK_END)
    while at + 9 <= length:
        file.seek(at)
        opcode, size = struct.unpack("<BQ", file.read(9))
        # No record has this opcode. Space on the disk that was never written consists of zeros.
        if opcode == 0:
            return
        # The size of a damaged record may be beyond the end of the file, or beyond any memory.
        content = file.read(min(size, length - at - 9)) if opcode in _OPCODES else b""
        at += 9 + size
        if opcode == _CHUNK:
            compression, begin = _text(content, 28)
            yield from _unpack_records(BytesIO(_decompress(compression, content[begin + 8 :])))
        elif len(content) == size:
            yield opcode, content


def check_stamp(stamp_ns: int) -> None:
    """Raise a StampError for a time above 63 bits, which MCAP can store but ROS cannot."""
    if stamp_ns >= 2**63:
        raise StampError(f"has a message with the time {stamp_ns} ns, which exceeds the largest time of ROS")


def _decompress(compression: str, data: bytes) -> bytes:
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
    """Read a string, and return it with the offset of the following byte."""
    end = at + 4 + int(struct.unpack_from("<I", data, at)[0])
    return data[at + 4 : end].decode(), end


def write_ahead_log(path: Path) -> Path | None:
    """Return the file of messages that SQLite has not yet moved into a .db3 file, if any."""
    log = path.with_name(f"{path.name}-wal")
    return log if path.suffix == ".db3" and log.is_file() and log.stat().st_size else None


def _sqlite(path: Path) -> Iterator[Sample]:
    from rosbags.rosbag2.metadata import parse_qos

    with ExitStack() as stack:
        if log := write_ahead_log(path):
            # SQLite writes next to such a file even to read it, and the bag's folder may be
            # read-only.
            folder = stack.enter_context(TemporaryDirectory())
            for source in (path, log):
                shutil.copyfile(source, Path(folder, source.name))
            path = Path(folder, path.name)
        database = sqlite3.connect(f"{path.absolute().as_uri()}?mode=ro", uri=True)
        # Otherwise SQLite rejects a file that is shorter than its header states.
        database.execute("PRAGMA writable_schema = ON")
        # Bags of Humble lack the table.
        for _ in database.execute(_DEFINITIONS_TABLE).fetchall():
            for type_name, encoding, text in database.execute(_DEFINITIONS):
                if encoding in TEXT_ENCODINGS:
                    add_stored_definition(type_name, text)
        topics = {}
        for topic, name, type_name, serialization_format, qos_text in database.execute(_TOPICS):
            check_format(path, name, serialization_format)
            topics[topic] = name, type_name, from_bag(parse_qos(qos_text))
        for stamp_ns, topic, cdr in database.execute(_MESSAGES):
            # Beyond the end of a truncated file all columns are NULL, and this raises a KeyError.
            name, type_name, qos = topics[topic]
            # SQLite stores any type in any column.
            if isinstance(stamp_ns, int) and isinstance(cdr, bytes):
                yield Sample(stamp_ns, name, type_name, cdr, qos, node=0)
