"""A bag that grows message by message."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.recording import bag_qos
from course_lib.ros.messages.definitions import definition, typestore
from course_lib.ros.messages.hashes import type_hash
from course_lib.ros.qos import Qos

if TYPE_CHECKING:
    from rosbags.interfaces import Connection

METADATA = "metadata.yaml"


class BagWriter:
    """The writer of a new bag of one file; a context manager, which leaves a cut-off bag after an error.

    Args:
        folder: The bag's folder, which is made.
        storage: "mcap" or "sqlite3".
        compression: What is compressed by zstd: "none", the whole "file", each "message", or the chunks that
            the "storage" makes of messages, in MCAP.
        custom_data: Texts by name for the metadata.
    """

    def __init__(
        self,
        folder: Path,
        storage: str = "mcap",
        *,
        compression: str = "none",
        custom_data: Mapping[str, str] | None = None,
    ) -> None:
        from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

        self._metadata = folder / METADATA
        self._writer = Writer(folder, version=9, storage_plugin=StoragePlugin[storage.upper()])
        self._writer.set_compression(CompressionMode[compression.upper()], CompressionFormat.ZSTD)
        for name, text in (custom_data or {}).items():
            self._writer.set_custom_data(name, text)
        self._writer.open()
        self._connections: dict[tuple[str, str], Connection] = {}

    def add(self, topic: str, type_name: str, offered: Sequence[Qos] = ()) -> None:
        """Add a topic; raises a CourseError for a type that is not known."""
        definition(type_name)  # says which type is not known
        self._connections[topic, type_name] = self._writer.add_connection(
            topic,
            type_name,
            typestore=typestore(),
            # As rosbag2 does: a part of an action has no file that could be quoted.
            msgdef="" if "/action/" in type_name else None,
            rihs01=type_hash(type_name),
            offered_qos_profiles=[bag_qos.to_bag(qos) for qos in offered],
        )

    def write(self, topic: str, type_name: str, stamp_ns: int, cdr: bytes) -> None:
        """Append a message of a topic that was added."""
        self._writer.write(self._connections[topic, type_name], stamp_ns, cdr)

    def close(self) -> None:
        """Complete the file and write the metadata."""
        self._writer.close()
        about = self._metadata.read_text(encoding="utf-8")  # where rosbags names itself, rosbag2 its ROS
        named = about.replace("ros_distro: rosbags", "ros_distro: jazzy")
        self._metadata.write_text(named, encoding="utf-8")

    def abort(self) -> None:
        """Leave a cut-off bag."""
        self._writer.abort()

    def __enter__(self) -> "BagWriter":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self.close()
        else:
            self.abort()
