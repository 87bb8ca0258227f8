"""Writers of bags."""

import weakref
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from operator import index
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.recording import BagWriter
from course_lib.ros.notices import say
from rosbag2_py._compression_options import FORMATS, CompressionOptions
from rosbag2_py._storage import (
    PRESETS,
    STORAGES,
    BagError,
    ConverterOptions,
    StorageOptions,
    TopicMetadata,
    get_default_storage_id,
)

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
        with _explained(folder):
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
        writer = self._opened()
        if topic_with_type.name not in self._types:
            with _explained(self._folder):
                writer.add(topic_with_type.name, topic_with_type.type, topic_with_type.offered_qos_profiles)
            self._types[topic_with_type.name] = topic_with_type.type

    def remove_topic(self, topic_with_type: TopicMetadata) -> None:
        """Reject further messages of a topic."""
        self._opened()
        self._types.pop(topic_with_type.name, None)

    def write(self, topic_name: str, message: bytes, time_stamp: int) -> None:
        """Append a message, given as CDR bytes, with its stamp [ns]."""
        writer = self._opened()
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
        with _explained(self._folder):
            writer.write(topic_name, self._types[topic_name], time_stamp, message)

    def take_snapshot(self) -> bool:
        """Write the cached messages. Return False if the bag was not opened in snapshot mode."""
        writer = self._opened()
        if not self._options.snapshot_mode:
            say("SequentialWriter take_snapshot called when snapshot mode is disabled")
            return False
        with _explained(self._folder):
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

    def _opened(self) -> BagWriter:
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
            say(f"{_ONE_FILE} {option}={getattr(options, option)} changes nothing.")
    return storage, presets[preset]


def _complete(writer: BagWriter, folder: Path) -> None:
    with _explained(folder):
        writer.close()


@contextmanager
def _explained(folder: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        reason = error.strerror or error
        raise BagError(f"Can't write the bag {folder}: {reason}. Choose another folder.") from error
    except CourseError as error:
        raise BagError(str(error)) from None
