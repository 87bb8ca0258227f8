"""Options, topics and metadata of bags."""

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any

from rclpy.duration import Duration
from rclpy.time import Time

from course_lib.errors import CourseError
from course_lib.ros.graph.topics import Qos

STORAGES = ("mcap", "sqlite3")


class BagError(CourseError, RuntimeError):
    """An error about a bag. It is also a RuntimeError, which ROS raises."""


def get_default_storage_id() -> str:
    """Return the storage of new bags if none is specified."""
    return STORAGES[0]


@dataclass
class ConverterOptions:
    """Serialization formats. Bags of the kit contain CDR, as in ROS."""

    input_serialization_format: str = ""
    output_serialization_format: str = ""


@dataclass
class StorageOptions:
    """The folder and storage of a bag, and how a writer handles messages.

    Only messages with stamps from `start_time_ns` to `end_time_ns` [ns] are written; -1 is no
    limit. With `snapshot_mode` the last `max_cache_size` bytes are kept until `take_snapshot()`
    writes them. Bags are not split here: a writer prints a notice if `max_bagfile_size` or
    `max_bagfile_duration` is set.
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


# Compressed parts by storage and preset profile.
PRESETS = {
    "mcap": {"none": "none", "fastwrite": "none", "zstd_fast": "storage", "zstd_small": "storage"},
    "sqlite3": {"none": "none", "resilient": "none"},
}


@dataclass
class StorageFilter:
    """The topics to read: the listed ones and those that match `regex`, or all, without the excluded ones."""

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
        """Return whether two topics are equal."""
        return self == other


@dataclass
class TopicInformation:
    """A topic of a bag and the number of its messages."""

    topic_metadata: TopicMetadata
    message_count: int


class ReadOrderSortBy(IntEnum):
    """The stamp by which messages are sorted."""

    ReceivedTimestamp = 0
    PublishedTimestamp = 1
    File = 2


@dataclass
class ReadOrder:
    """The order of reading. In the kit's bags it is the same for every kind of stamp."""

    sort_by: ReadOrderSortBy = ReadOrderSortBy.ReceivedTimestamp
    reverse: bool = False


@dataclass(repr=False)
class BagMetadata:
    """The metadata of a bag. Its string is the output of `ros2 bag info`."""

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


class _NotOffered:
    instead = ""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        raise BagError(f"The kit has no rosbag2_py.{type(self).__name__}. Instead: {self.instead}")


class LocalMessageDefinitionSource(_NotOffered):
    """Writes type definitions to files. Not implemented."""

    instead = "ros2 interface show TYPE."


class MetadataIo(_NotOffered):
    """Reads and writes metadata files. Not implemented."""

    instead = "rosbag2_py.Info().read_metadata(uri, storage_id)."


class Player(_NotOffered):
    """Plays bags. Not implemented."""

    instead = "ros2 bag play BAG, or a SequentialReader and publish(cdr) in a timer."


class PlayOptions(Player):
    """Options of a Player. Not implemented."""


class Recorder(_NotOffered):
    """Records bags. Not implemented."""

    instead = "ros2 bag record TOPIC, or a SequentialWriter in a subscription's callback."


class RecordOptions(Recorder):
    """Options of a Recorder. Not implemented."""


class Reindexer(_NotOffered):
    """Restores missing metadata. Not implemented."""

    instead = "nothing is needed: the kit reads bags whose metadata.yaml is missing."


def bag_rewrite(*args: Any) -> None:
    """Raise a BagError, as converting bags is not implemented."""
    raise BagError("The kit has no rosbag2_py.bag_rewrite. Instead: SequentialReader and SequentialWriter.")
