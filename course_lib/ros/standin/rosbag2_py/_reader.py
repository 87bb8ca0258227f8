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
    """A reader of one message after the other; the storage is found out, whatever the options name."""

    def __init__(self) -> None:
        self._recording: Recording | None = None
        self._filter = StorageFilter()
        self._reverse = False
        self._at = 0

    def open(self, storage_options: StorageOptions, converter_options: ConverterOptions) -> None:
        """Open a bag; raises a RuntimeError where there is none."""
        self.open_uri(storage_options.uri)

    def open_uri(self, uri: str) -> None:
        """Open a bag by its folder, or by the file in it."""
        self._recording = whole(uri)
        self._folder = folder_of(uri)
        self._samples = sorted(self._recording.samples, key=lambda sample: sample.stamp_ns)
        self._at = 0

    def close(self) -> None:
        """Close the bag."""
        self._recording = None

    def has_next(self) -> bool:
        """Return whether a message is left, of the topics that are asked for."""
        self._opened()
        while self._at < len(self._samples) and not _passes(self._filter, self._samples[self._at].topic):
            self._at += 1
        return self._at < len(self._samples)

    def read_next(self) -> tuple[str, bytes, int]:
        """Return the next message: topic, CDR bytes and stamp in [ns]."""
        if not self.has_next():
            raise BagError("Bag is at end. No next message.")
        sample = self._samples[self._at]
        self._at += 1
        return sample.topic, sample.cdr, sample.stamp_ns

    def seek(self, timestamp: int) -> None:
        """Go to the first message at or after a stamp, [ns]; when reading backwards, at or before it."""
        self._opened()
        sign = -1 if self._reverse else 1
        self._at = bisect_left(self._samples, sign * timestamp, key=lambda sample: sign * sample.stamp_ns)

    def set_filter(self, storage_filter: StorageFilter) -> None:
        """Read some topics only, from here on."""
        self._filter = storage_filter

    def reset_filter(self) -> None:
        """Read all topics again, from here on."""
        self._filter = StorageFilter()

    def set_read_order(self, order: ReadOrder) -> bool:
        """Read in an order, from here on; True: it can be done."""
        self._opened()
        if order.reverse != self._reverse:
            self._reverse = order.reverse
            self._samples.reverse()
            self._at = len(self._samples) - self._at if self._at else 0
        return True

    def get_all_topics_and_types(self) -> list[TopicMetadata]:
        """List the topics."""
        return [topic.topic_metadata for topic in topics(self._folder, self._opened())]

    def get_metadata(self) -> BagMetadata:
        """Return the metadata of the bag."""
        return metadata(self._folder, self._opened())

    def _opened(self) -> Recording:
        if self._recording is None:
            raise BagError("Bag is not open. Call open() before reading.")
        return self._recording


class SequentialCompressionReader(SequentialReader):
    """A reader of compressed bags; the other one reads them here, too."""


def get_registered_readers() -> set[str]:
    """Return the storages that can be read."""
    return set(STORAGES)


def _passes(chosen: StorageFilter, topic: str) -> bool:
    named = [*chosen.topics, *chosen.services_events]
    wanted = topic in named or bool(chosen.regex and re.search(chosen.regex, topic))
    excluded = topic in [*chosen.exclude_topics, *chosen.exclude_service_events]
    excluded = excluded or bool(chosen.regex_to_exclude and re.search(chosen.regex_to_exclude, topic))
    return (wanted or not (named or chosen.regex)) and not excluded
