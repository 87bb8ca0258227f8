"""The metadata of bags."""

from functools import partial
from pathlib import Path

from rclpy.duration import Duration
from rclpy.time import Time

from course_lib.errors import CourseError
from course_lib.recording import Recording, bag_info, bag_metadata, read_bag, topic_counts
from course_lib.recording.bag import data_files
from rosbag2_py._storage import BagError, BagMetadata, TopicInformation, TopicMetadata


def folder_of(uri: str) -> Path:
    """Return the folder of a bag. If a bag has one file, `uri` may also be this file.

    Raises:
        BagError: The file is one of several.
    """
    path = Path(uri)
    if path.suffix not in (".mcap", ".db3") or not path.is_file():
        return path
    if data_files(path.parent) != [path]:
        raise BagError(f"{path} is one of several files. Open the bag's folder: {path.parent}.")
    return path.parent


def whole(uri: str) -> Recording:
    """Read a bag. Raise a BagError if there is none."""
    try:
        return read_bag(folder_of(uri))
    except CourseError as error:
        raise BagError(str(error)) from None


class Info:
    """Reads the metadata of bags."""

    def read_metadata(self, uri: str, storage_id: str) -> BagMetadata:
        """Return the metadata of a bag. Its storage is detected, so `storage_id` has no effect."""
        return metadata(folder_of(uri), whole(uri))


def metadata(folder: Path, recording: Recording) -> BagMetadata:
    """Return a bag's metadata, or compute it from the content if its recorder was killed."""
    about = bag_metadata(folder)
    files = [name for name in about.get("relative_file_paths", ()) if (folder / name).is_file()]
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
    """List the topics of a bag, including topics without messages."""
    offered_qos = {(topic.name, topic.type_name): list(topic.offered) for topic in recording.topics()}
    counts = topic_counts(bag_metadata(folder), recording)
    return [
        TopicInformation(TopicMetadata(number, name, kind, "cdr", offered_qos.get((name, kind), [])), count)
        for number, ((name, kind), count) in enumerate(counts.items(), start=1)
    ]
