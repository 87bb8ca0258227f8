"""Writers of bags."""

import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from operator import index
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.recording import BagWriter
from rosbag2_py._storage import (
    STORAGES,
    BagError,
    ConverterOptions,
    StorageOptions,
    TopicMetadata,
    get_default_storage_id,
)

_CLOSED = "Bag is not open. Call open() before writing."


class SequentialWriter:
    """A writer of messages in the order in which they come; the bag is closed with it."""

    def __init__(self) -> None:
        self._writer: BagWriter | None = None
        self._types: dict[str, str] = {}
        self._close: Callable[[], object] = lambda: None

    def open(self, storage_options: StorageOptions, converter_options: ConverterOptions) -> None:
        """Create the bag; raises a RuntimeError where its folder is there already, or its storage unknown."""
        self.close()
        storage = storage_options.storage_id or get_default_storage_id()
        if storage not in STORAGES:
            raise BagError(f"There is no storage {storage!r}. Choose one of {', '.join(STORAGES)}.")
        folder = Path(storage_options.uri)
        if folder.exists():
            raise BagError(f"Bag directory already exists ({folder}), can't overwrite existing bag")
        with _explained(folder):
            self._writer = BagWriter(folder, storage)
        self._folder, self._types = folder, {}
        self._close = weakref.finalize(self, _complete, self._writer, folder)  # also where Python ends

    def create_topic(self, topic_with_type: TopicMetadata) -> None:
        """Add a topic; raises a RuntimeError for a type that is not known."""
        writer = self._opened()
        if topic_with_type.name not in self._types:
            with _explained(self._folder):
                writer.add(topic_with_type.name, topic_with_type.type, topic_with_type.offered_qos_profiles)
            self._types[topic_with_type.name] = topic_with_type.type

    def remove_topic(self, topic_with_type: TopicMetadata) -> None:
        """Accept no more messages of a topic."""
        self._opened()
        self._types.pop(topic_with_type.name, None)

    def write(self, topic_name: str, message: bytes, time_stamp: int) -> None:
        """Append a message, as CDR bytes, with its stamp in [ns]."""
        writer = self._opened()
        if topic_name not in self._types:
            raise BagError(
                f"Failed to write on topic '{topic_name}'. Call create_topic() before first write."
            )
        if not isinstance(message, bytes):
            raise TypeError(f"Expected bytes, got {type(message)}: call serialize_message(message) first.")
        if index(time_stamp) < 0:
            raise BagError(f"Failed to write on topic '{topic_name}': the stamp {time_stamp} is below 0 ns.")
        with _explained(self._folder):
            writer.write(topic_name, self._types[topic_name], time_stamp, message)

    def close(self) -> None:
        """Complete the bag."""
        self._writer = None
        self._close()

    def _opened(self) -> BagWriter:
        if self._writer is None:
            raise BagError(_CLOSED)
        return self._writer


def get_registered_writers() -> set[str]:
    """Return the storages that can be written."""
    return set(STORAGES)


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
