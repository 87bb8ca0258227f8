"""Everything that was published in a run: kept, stored as a rosbag2 bag, read back."""

from course_lib.recording.bag import read_bag, write_bag
from course_lib.recording.bag_info import bag_info
from course_lib.recording.recording import Recorder, Recording, TopicSummary, record

__all__ = ["Recorder", "Recording", "TopicSummary", "bag_info", "read_bag", "record", "write_bag"]
