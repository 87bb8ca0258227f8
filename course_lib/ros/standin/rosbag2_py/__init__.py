"""Readers and writers of bags, with their options and metadata; ROS has modules for each of them."""

import re
import weakref
from bisect import bisect_left
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from enum import IntEnum
from functools import partial
from operator import index
from pathlib import Path
from typing import Any

from rclpy.duration import Duration
from rclpy.time import Time

from course_lib.errors import CourseError
from course_lib.recording import (
    BagWriter,
    Recording,
    bag_info,
    bag_metadata,
    read_bag,
    topic_counts,
)
from course_lib.recording.storage import data_files
from course_lib.ros.graph.topics import Qos
from course_lib.ros.notices import print_notice

STORAGES = ("mcap", "sqlite3")


class BagError(CourseError, RuntimeError):
    """An error about a bag. It is also a RuntimeError, which ROS raises."""


def get_default_storage_id() -> str:
    """Return the storage of new bags if none is specified."""
    return STORAGES[0]


@dataclass
class ConverterOptions:
    """Serialization formats. Bags of the kit contain CDR, as in ROS."""

    input_serialization_format: str = ""
    output_serialization_format: str = ""


@dataclass
class StorageOptions:
    """The folder and storage of a bag, and how a writer handles messages.

    Only messages with stamps from `start_time_ns` to `end_time_ns` [ns] are written; -1 is no
    limit. With `snapshot_mode` the last `max_cache_size` bytes are kept until `take_snapshot()`
    writes them. Bags are not split here: a writer prints a notice if `max_bagfile_size` or
    `max_bagfile_duration` is set.
    """

    uri: str
    storage_id: str = ""
    max_bagfile_size: int = 0
    max_bagfile_duration: int = 0
    max_cache_size: int = 0
    storage_preset_profile: str = ""
    storage_config_uri: str = ""
    snapshot_mode: bool = False
    start_time_ns: int = -1
    end_time_ns: int = -1
    custom_data: dict[str, str] = field(default_factory=dict)


# Compressed parts by storage and preset profile.
PRESETS = {
    "mcap": {"none": "none", "fastwrite": "none", "zstd_fast": "storage", "zstd_small": "storage"},
    "sqlite3": {"none": "none", "resilient": "none"},
}


@dataclass
class StorageFilter:
    """The topics to read: all, or listed and matching topics (`regex`), except excluded ones."""

    topics: list[str] = field(default_factory=list)
    services_events: list[str] = field(default_factory=list)
    regex: str = ""
    exclude_topics: list[str] = field(default_factory=list)
    exclude_service_events: list[str] = field(default_factory=list)
    regex_to_exclude: str = ""


@dataclass
class TopicMetadata:
    """A topic of a bag."""

    id: int
    name: str
    type: str
    serialization_format: str
    offered_qos_profiles: list[Qos] = field(default_factory=list)
    type_description_hash: str = ""

    def equals(self, other: "TopicMetadata") -> bool:
        """Return whether two topics are equal."""
        return self == other


@dataclass
class TopicInformation:
    """A topic of a bag and the number of its messages."""

    topic_metadata: TopicMetadata
    message_count: int


class ReadOrderSortBy(IntEnum):
    """The stamp by which messages are sorted."""

    ReceivedTimestamp = 0
    PublishedTimestamp = 1
    File = 2


@dataclass
class ReadOrder:
    """The order of reading. In the kit's bags it is the same for every kind of stamp."""

    sort_by: ReadOrderSortBy = ReadOrderSortBy.ReceivedTimestamp
    reverse: bool = False


@dataclass(repr=False)
class BagMetadata:
    """The metadata of a bag. Its string is the output of `ros2 bag info`."""

    version: int = 9
    bag_size: int = 0
    storage_identifier: str = ""
    relative_file_paths: list[str] = field(default_factory=list)
    duration: Duration = field(default_factory=Duration)
    starting_time: Time = field(default_factory=Time)
    message_count: int = 0
    topics_with_message_count: list[TopicInformation] = field(default_factory=list)
    compression_format: str = ""
    compression_mode: str = ""
    custom_data: dict[str, str] = field(default_factory=dict)
    ros_distro: str = ""
    text: Callable[[], str] = field(default=str, compare=False)

    def __repr__(self) -> str:
        # Whoever prints it adds the last line break.
        return self.text().removesuffix("\n")


class _NotOffered:
    instead = ""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        raise BagError(f"The kit has no rosbag2_py.{type(self).__name__}. Instead: {self.instead}")


class LocalMessageDefinitionSource(_NotOffered):
    """Writes type definitions to files. Not implemented."""

    instead = "ros2 interface show TYPE."


class MetadataIo(_NotOffered):
    """Reads and writes metadata files. Not implemented."""

    instead = "rosbag2_py.Info().read_metadata(uri, storage_id)."


class Player(_NotOffered):
    """Plays bags. Not implemented."""

    instead = "ros2 bag play BAG, or a SequentialReader and publish(cdr) in a timer."


class PlayOptions(Player):
    """Options of a Player. Not implemented."""


class Recorder(_NotOffered):
    """Records bags. Not implemented."""

    instead = "ros2 bag record TOPIC, or a SequentialWriter in a subscription's callback."


class RecordOptions(Recorder):
    """Options of a Recorder. Not implemented."""


class Reindexer(_NotOffered):
    """Restores missing metadata. Not implemented."""

    instead = "nothing is needed: the kit reads bags whose metadata.yaml is missing."


def bag_rewrite(*args: Any) -> None:
    """Raise a BagError, as converting bags is not implemented."""
    raise BagError("The kit has no rosbag2_py.bag_rewrite. Instead: SequentialReader and SequentialWriter.")


def folder_of(uri: str) -> Path:
    """Return the folder of a bag. If a bag has one file, `uri` may also be this file.

    Raises:
        BagError: The file is one of several.
    """
    path = Path(uri)
    if path.suffix not in (".mcap", ".db3") or not path.is_file():
        return path
    if data_files(path.parent) != [path]:
        raise BagError(f"{path} is one of several files. Open the bag's folder: {path.parent}.")
    return path.parent


def read_recording(uri: str) -> Recording:
    """Read a bag. Raise a BagError if there is none."""
    try:
        return read_bag(folder_of(uri))
    except CourseError as error:
        raise BagError(str(error)) from None


class Info:
    """Reads the metadata of bags."""

    def read_metadata(self, uri: str, storage_id: str) -> BagMetadata:
        """Return the metadata of a bag. Its storage is detected, so `storage_id` has no effect."""
        return metadata(folder_of(uri), read_recording(uri))


def metadata(folder: Path, recording: Recording) -> BagMetadata:
    """Return a bag's metadata, or compute it from the content if its recorder was killed."""
    about = bag_metadata(folder)
    files = [name for name in about.get("relative_file_paths", ()) if (folder / name).is_file()]
    return BagMetadata(
        version=about.get("version", 9),
        bag_size=sum((folder / name).stat().st_size for name in files),
        storage_identifier=about.get("storage_identifier", ""),
        relative_file_paths=files,
        duration=Duration(nanoseconds=recording.end_ns - recording.start_ns),
        starting_time=Time(nanoseconds=recording.start_ns),
        message_count=len(recording.samples),
        topics_with_message_count=topics(folder, recording),
        compression_format=about.get("compression_format", ""),
        compression_mode=about.get("compression_mode", ""),
        custom_data=about.get("custom_data") or {},
        ros_distro=about.get("ros_distro") or "",
        text=partial(bag_info, folder, digest=False),
    )


def topics(folder: Path, recording: Recording) -> list[TopicInformation]:
    """List the topics of a bag, including topics without messages."""
    offered_qos = {(topic.name, topic.type_name): list(topic.offered) for topic in recording.topics()}
    counts = topic_counts(bag_metadata(folder), recording)
    return [
        TopicInformation(TopicMetadata(number, name, kind, "cdr", offered_qos.get((name, kind), [])), count)
        for number, ((name, kind), count) in enumerate(counts.items(), start=1)
    ]


FORMATS = ("zstd",)


class CompressionMode(IntEnum):
    """The parts of a bag that are compressed."""

    NONE = 0
    FILE = 1
    MESSAGE = 2


NONE, FILE, MESSAGE = CompressionMode


@dataclass
class CompressionOptions:
    """Compression of a bag. The numbers of queues and threads have no effect on its content."""

    compression_format: str = ""
    compression_mode: CompressionMode = CompressionMode.NONE
    compression_queue_size: int = 1
    compression_threads: int = 0

    def checked(self) -> str:
        """Return the compressed units: files or messages.

        Raises:
            BagError: Nothing is compressed, or the format is unknown.
        """
        if self.compression_mode == CompressionMode.NONE:
            raise BagError("SequentialCompressionWriter requires a CompressionMode that is not NONE!")
        if self.compression_format not in FORMATS:
            raise BagError(
                f"There is no compression {self.compression_format!r}. Choose one of {', '.join(FORMATS)}."
            )
        return self.compression_mode.name.lower()


def compression_mode_from_string(compression_mode: str) -> CompressionMode:
    """Return the mode with this name, ignoring case. An empty name means NONE."""
    try:
        return CompressionMode[compression_mode.upper() or "NONE"]
    except KeyError:
        raise BagError(
            f"CompressionMode: {compression_mode!r} is not recognized. Choose NONE, FILE or MESSAGE."
        ) from None


def compression_mode_to_string(compression_mode: CompressionMode) -> str:
    """Return the name of a mode."""
    return CompressionMode(compression_mode).name


class SequentialReader:
    """Reads messages one after the other. The storage is detected, regardless of the options."""

    def __init__(self) -> None:
        self._recording: Recording | None = None
        self._filter = StorageFilter()
        self._reverse = False
        self._at = 0

    def open(self, storage_options: StorageOptions, converter_options: ConverterOptions) -> None:
        """Open a bag. Raise a RuntimeError if there is none."""
        self.open_uri(storage_options.uri)

    def open_uri(self, uri: str) -> None:
        """Open a bag, given by its folder or by its only file."""
        self._recording = read_recording(uri)
        self._folder = folder_of(uri)
        self._samples = sorted(self._recording.samples, key=lambda sample: sample.stamp_ns)
        self._at = 0

    def close(self) -> None:
        """Close the bag."""
        self._recording = None

    def has_next(self) -> bool:
        """Return whether there is a further message on the selected topics."""
        self._require_open()
        while self._at < len(self._samples) and not _is_selected(self._filter, self._samples[self._at].topic):
            self._at += 1
        return self._at < len(self._samples)

    def read_next(self) -> tuple[str, bytes, int]:
        """Return the topic, CDR bytes and stamp [ns] of the next message."""
        if not self.has_next():
            raise BagError("Bag is at end. No next message.")
        sample = self._samples[self._at]
        self._at += 1
        return sample.topic, sample.cdr, sample.stamp_ns

    def seek(self, timestamp: int) -> None:
        """Move to the first message at or after a stamp [ns].

        When reading backwards, move to the last message at or before it.
        """
        self._require_open()
        sign = -1 if self._reverse else 1
        self._at = bisect_left(self._samples, sign * timestamp, key=lambda sample: sign * sample.stamp_ns)

    def set_filter(self, storage_filter: StorageFilter) -> None:
        """Select the topics to read from now on."""
        self._filter = storage_filter

    def reset_filter(self) -> None:
        """Read all topics from now on."""
        self._filter = StorageFilter()

    def set_read_order(self, order: ReadOrder) -> bool:
        """Set the order of reading from now on. Return True, because every order is supported."""
        self._require_open()
        if order.reverse != self._reverse:
            self._reverse = order.reverse
            self._samples.reverse()
            self._at = len(self._samples) - self._at if self._at else 0
        return True

    def get_all_topics_and_types(self) -> list[TopicMetadata]:
        """List the topics of the bag."""
        return [topic.topic_metadata for topic in topics(self._folder, self._require_open())]

    def get_metadata(self) -> BagMetadata:
        """Return the metadata of the bag."""
        return metadata(self._folder, self._require_open())

    def _require_open(self) -> Recording:
        if self._recording is None:
            raise BagError("Bag is not open. Call open() before reading.")
        return self._recording


class SequentialCompressionReader(SequentialReader):
    """A reader of compressed bags, which SequentialReader reads here as well."""


def get_registered_readers() -> set[str]:
    """Return the supported storages."""
    return set(STORAGES)


def _is_selected(storage_filter: StorageFilter, topic: str) -> bool:
    names = [*storage_filter.topics, *storage_filter.services_events]
    is_included = topic in names or bool(storage_filter.regex and re.search(storage_filter.regex, topic))
    is_excluded = topic in [*storage_filter.exclude_topics, *storage_filter.exclude_service_events]
    is_excluded = is_excluded or bool(
        storage_filter.regex_to_exclude and re.search(storage_filter.regex_to_exclude, topic)
    )
    return (is_included or not (names or storage_filter.regex)) and not is_excluded


_ONE_FILE = "A bag of the kit is one file."
_CLOSED = "Bag is not open. Call open() before writing."


class SequentialWriter:
    """Writes messages to a bag in the order of the calls.

    The bag is closed when the writer is deleted.
    """

    def __init__(self) -> None:
        self._writer: BagWriter | None = None
        self._types: dict[str, str] = {}
        self._compression = ""
        self._options = StorageOptions("")
        self._cache: deque[tuple[str, bytes, int]] = deque()
        self._close: Callable[[], object] = lambda: None

    def open(self, storage_options: StorageOptions, converter_options: ConverterOptions) -> None:
        """Create a bag. Raise a RuntimeError if its folder exists or an option is unknown."""
        self.close()
        storage, compression = _check_options(storage_options, converter_options)
        folder = Path(storage_options.uri)
        if folder.exists():
            raise BagError(f"Bag directory already exists ({folder}), can't overwrite existing bag")
        with _raise_bag_errors(folder):
            self._writer = BagWriter(
                folder,
                storage,
                compression=self._compression or compression,
                custom_data=storage_options.custom_data,
            )
        self._folder, self._types, self._options = folder, {}, storage_options
        self._cache.clear()
        # Also closes the bag when Python exits.
        self._close = weakref.finalize(self, _complete, self._writer, folder)

    def create_topic(self, topic_with_type: TopicMetadata) -> None:
        """Add a topic. Raise a RuntimeError if its type is unknown."""
        writer = self._require_open()
        if topic_with_type.name not in self._types:
            with _raise_bag_errors(self._folder):
                writer.add(topic_with_type.name, topic_with_type.type, topic_with_type.offered_qos_profiles)
            self._types[topic_with_type.name] = topic_with_type.type

    def remove_topic(self, topic_with_type: TopicMetadata) -> None:
        """Reject further messages of a topic."""
        self._require_open()
        self._types.pop(topic_with_type.name, None)

    def write(self, topic_name: str, message: bytes, time_stamp: int) -> None:
        """Append a message, given as CDR bytes, with its stamp [ns]."""
        writer = self._require_open()
        if topic_name not in self._types:
            raise BagError(
                f"Failed to write on topic '{topic_name}'. Call create_topic() before first write."
            )
        if not isinstance(message, bytes):
            raise TypeError(f"Expected bytes, got {type(message)}: call serialize_message(message) first.")
        if index(time_stamp) < 0:
            raise BagError(f"Failed to write on topic '{topic_name}': the stamp {time_stamp} is below 0 ns.")
        begin_ns, end_ns = self._options.start_time_ns, self._options.end_time_ns
        if 0 <= begin_ns > time_stamp or 0 <= end_ns < time_stamp:
            return
        if self._options.snapshot_mode:
            self._cache.append((topic_name, message, time_stamp))
            size = sum(len(data_cached) for _, data_cached, _ in self._cache)
            while size > self._options.max_cache_size:
                size -= len(self._cache.popleft()[1])
            return
        with _raise_bag_errors(self._folder):
            writer.write(topic_name, self._types[topic_name], time_stamp, message)

    def take_snapshot(self) -> bool:
        """Write the cached messages. Return False if the bag was not opened in snapshot mode."""
        writer = self._require_open()
        if not self._options.snapshot_mode:
            print_notice("SequentialWriter take_snapshot called when snapshot mode is disabled")
            return False
        with _raise_bag_errors(self._folder):
            for topic, message, stamp_ns in self._cache:
                writer.write(topic, self._types[topic], stamp_ns, message)
        self._cache.clear()
        return True

    def split_bagfile(self) -> None:
        """Raise a BagError, as bags are not split here."""
        raise BagError(f"{_ONE_FILE} Close the bag and open another one.")

    def close(self) -> None:
        """Complete and close the bag."""
        self._writer = None
        self._close()

    def _require_open(self) -> BagWriter:
        if self._writer is None:
            raise BagError(_CLOSED)
        return self._writer


class SequentialCompressionWriter(SequentialWriter):
    """A writer that compresses the whole file or each message."""

    def __init__(self, compression_options: CompressionOptions) -> None:
        super().__init__()
        self._compression = compression_options.checked()


def get_registered_compressors() -> set[str]:
    """Return the supported compression formats."""
    return set(FORMATS)


def get_registered_writers() -> set[str]:
    """Return the supported storages."""
    return set(STORAGES)


def _check_options(options: StorageOptions, converter: ConverterOptions) -> tuple[str, str]:
    """Return the storage and compression of a new bag.

    Reject options that the kit does not support.
    """
    storage = options.storage_id or get_default_storage_id()
    if storage not in STORAGES:
        raise BagError(f"There is no storage {storage!r}. Choose one of {', '.join(STORAGES)}.")
    presets, preset = PRESETS[storage], options.storage_preset_profile or "none"
    if preset not in presets:
        raise BagError(f"unknown storage preset profile (valid options are {', '.join(presets)}): {preset}")
    for name in (converter.input_serialization_format, converter.output_serialization_format):
        if name not in ("", "cdr"):
            raise BagError(f"The kit's bags hold cdr; it can't convert to or from {name!r}.")
    if options.storage_config_uri:
        raise BagError(
            "The kit reads no storage_config_uri. Leave it out, or choose a storage_preset_profile."
        )
    if options.snapshot_mode and options.max_cache_size <= 0:
        raise BagError("Max cache size must be greater than 0 when snapshot mode is enabled")
    for option in ("max_bagfile_size", "max_bagfile_duration"):
        if getattr(options, option):
            print_notice(f"{_ONE_FILE} {option}={getattr(options, option)} changes nothing.")
    return storage, presets[preset]


def _complete(writer: BagWriter, folder: Path) -> None:
    with _raise_bag_errors(folder):
        writer.close()


@contextmanager
def _raise_bag_errors(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        reason = error.strerror or error
        raise BagError(f"Can't write the bag {folder}: {reason}. Choose another folder.") from error
    except CourseError as error:
        raise BagError(str(error)) from None
