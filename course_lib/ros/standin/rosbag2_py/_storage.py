"""Options, topics and metadata of bags."""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum

from rclpy.duration import Duration
from rclpy.time import Time

from course_lib.errors import CourseError
from course_lib.ros.qos import Qos

STORAGES = ("mcap", "sqlite3")


class BagError(CourseError, RuntimeError):
    """An error of a bag; ROS raises a RuntimeError."""


def get_default_storage_id() -> str:
    """Return the storage of bags for which none is named."""
    return STORAGES[0]


@dataclass
class ConverterOptions:
    """Serialization formats; bags of the kit hold CDR, as those of ROS."""

    input_serialization_format: str = ""
    output_serialization_format: str = ""


@dataclass
class StorageOptions:
    """A bag's folder and storage, and what a writer does with messages.

    Only messages whose stamps are from `start_time_ns` to `end_time_ns` are written, [ns]; -1 is no limit.
    With `snapshot_mode` the last `max_cache_size` bytes are kept until `take_snapshot()` writes them. Bags
    are one file here: a writer says so where `max_bagfile_size` or `max_bagfile_duration` ask for several.
    """

    uri: str
    storage_id: str = ""
    max_bagfile_size: int = 0
    max_bagfile_duration: int = 0
    max_cache_size: int = 0
    storage_preset_profile: str = ""
    storage_config_uri: str = ""
    snapshot_mode: bool = False
    start_time_ns: int = -1
    end_time_ns: int = -1
    custom_data: dict[str, str] = field(default_factory=dict)


PRESETS = {
    "mcap": {"none": "none", "fastwrite": "none", "zstd_fast": "storage", "zstd_small": "storage"},
    "sqlite3": {"none": "none", "resilient": "none"},
}  # storage -> preset profile -> what is compressed


@dataclass
class StorageFilter:
    """The topics to read: those named or matching `regex`, or all; without the excluded ones."""

    topics: list[str] = field(default_factory=list)
    services_events: list[str] = field(default_factory=list)
    regex: str = ""
    exclude_topics: list[str] = field(default_factory=list)
    exclude_service_events: list[str] = field(default_factory=list)
    regex_to_exclude: str = ""


@dataclass
class TopicMetadata:
    """A topic of a bag."""

    id: int
    name: str
    type: str
    serialization_format: str
    offered_qos_profiles: list[Qos] = field(default_factory=list)
    type_description_hash: str = ""

    def equals(self, other: "TopicMetadata") -> bool:
        """Return whether two topics are the same."""
        return self == other


@dataclass
class TopicInformation:
    """A topic of a bag with the count of its messages."""

    topic_metadata: TopicMetadata
    message_count: int


class ReadOrderSortBy(IntEnum):
    """The stamps that messages are read by."""

    ReceivedTimestamp = 0
    PublishedTimestamp = 1
    File = 2


@dataclass
class ReadOrder:
    """An order of reading; a bag of the kit has the same one by each kind of stamp."""

    sort_by: ReadOrderSortBy = ReadOrderSortBy.ReceivedTimestamp
    reverse: bool = False


@dataclass(repr=False)
class BagMetadata:
    """The content of a bag in numbers; its text is that of `ros2 bag info`."""

    version: int = 9
    bag_size: int = 0
    storage_identifier: str = ""
    relative_file_paths: list[str] = field(default_factory=list)
    duration: Duration = field(default_factory=Duration)
    starting_time: Time = field(default_factory=Time)
    message_count: int = 0
    topics_with_message_count: list[TopicInformation] = field(default_factory=list)
    compression_format: str = ""
    compression_mode: str = ""
    custom_data: dict[str, str] = field(default_factory=dict)
    ros_distro: str = ""
    text: Callable[[], str] = field(default=str, compare=False)

    def __repr__(self) -> str:
        return self.text()
