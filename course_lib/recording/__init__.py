"""Recordings of all published messages of a run, and rosbag2 bags of them."""

from course_lib.recording.bag import read_bag, write_bag
from course_lib.recording.bag_info import bag_info
from course_lib.recording.recording import Recorder, Recording, TopicSummary, record

__all__ = ["Recorder", "Recording", "TopicSummary", "bag_info", "read_bag", "record", "write_bag"]
