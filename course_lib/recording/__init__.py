"""Recordings of all published messages of a run, and rosbag2 bags of them."""

from course_lib.recording.bag import read_bag, write_bag
from course_lib.recording.bag_info import bag_info, bag_metadata, topic_counts
from course_lib.recording.bag_recorder import recorded
from course_lib.recording.bag_writer import BagWriter
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
