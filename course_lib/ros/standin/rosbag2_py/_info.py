"""The metadata of bags."""

from functools import partial
from pathlib import Path

from rclpy.duration import Duration
from rclpy.time import Time

from course_lib.recording import Recording, bag_info, bag_metadata, topic_counts
from rosbag2_py._storage import BagMetadata, TopicInformation, TopicMetadata
from rosbag2_py._uri import folder_of, whole


class Info:
    """A reader of metadata."""

    def read_metadata(self, uri: str, storage_id: str) -> BagMetadata:
        """Return the metadata of a bag; its storage is found out."""
        return metadata(folder_of(uri), whole(uri))


def metadata(folder: Path, recording: Recording) -> BagMetadata:
    """Return the metadata of a bag; where a recorder was killed, of what it holds."""
    about = bag_metadata(folder)
    files = [str(name) for name in about.get("relative_file_paths", ())]
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
    """List the topics of a bag, also those without messages."""
    offered = {(topic.name, topic.type_name): list(topic.offered) for topic in recording.topics()}
    counts = topic_counts(bag_metadata(folder), recording)
    return [
        TopicInformation(TopicMetadata(number, name, kind, "cdr", offered.get((name, kind), [])), count)
        for number, ((name, kind), count) in enumerate(counts.items(), start=1)
    ]
