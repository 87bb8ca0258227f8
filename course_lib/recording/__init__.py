"""Recordings of all messages published in a run, and rosbag2 bags of them."""

from course_lib.recording.bag import (
    BagWriter,
    Recorder,
    Recording,
    TopicSummary,
    bag_info,
    bag_metadata,
    read_bag,
    record,
    recorded,
    topic_counts,
    write_bag,
)

__all__ = [
    "BagWriter",
    "Recorder",
    "Recording",
    "TopicSummary",
    "bag_info",
    "bag_metadata",
    "read_bag",
    "record",
    "recorded",
    "topic_counts",
    "write_bag",
]
