"""Recordings of all messages published in a run, and rosbag2 bags of them."""

from course_lib.recording.bag import (
    BagWriter,
    bag_info,
    bag_metadata,
    read_bag,
    recorded,
    topic_counts,
    write_bag,
)
from course_lib.recording.recording import Recorder, Recording, TopicSummary, record

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
