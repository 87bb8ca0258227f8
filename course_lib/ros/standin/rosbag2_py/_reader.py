"""Readers of bags."""

import re
from bisect import bisect_left

from course_lib.recording import Recording
from rosbag2_py._info import folder_of, metadata, topics, whole
from rosbag2_py._storage import (
    STORAGES,
    BagError,
    BagMetadata,
    ConverterOptions,
    ReadOrder,
    StorageFilter,
    StorageOptions,
    TopicMetadata,
)


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
        self._recording = whole(uri)
        self._folder = folder_of(uri)
        self._samples = sorted(self._recording.samples, key=lambda sample: sample.stamp_ns)
        self._at = 0

    def close(self) -> None:
        """Close the bag."""
        self._recording = None

    def has_next(self) -> bool:
        """Return whether there is a further message on the selected topics."""
        self._opened()
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
        self._opened()
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
        self._opened()
        if order.reverse != self._reverse:
            self._reverse = order.reverse
            self._samples.reverse()
            self._at = len(self._samples) - self._at if self._at else 0
        return True

    def get_all_topics_and_types(self) -> list[TopicMetadata]:
        """List the topics of the bag."""
        return [topic.topic_metadata for topic in topics(self._folder, self._opened())]

    def get_metadata(self) -> BagMetadata:
        """Return the metadata of the bag."""
        return metadata(self._folder, self._opened())

    def _opened(self) -> Recording:
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
