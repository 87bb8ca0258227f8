"""Classes of rosbag2_py that the kit does not have."""

from typing import Any

from rosbag2_py._storage import BagError


class _NotOffered:
    instead = ""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        raise BagError(f"The kit has no rosbag2_py.{type(self).__name__}. Instead: {self.instead}")


class LocalMessageDefinitionSource(_NotOffered):
    """The texts of types, as files."""

    instead = "ros2 interface show TYPE."


class MetadataIo(_NotOffered):
    """Files of metadata."""

    instead = "rosbag2_py.Info().read_metadata(uri, storage_id)."


class Player(_NotOffered):
    """A player."""

    instead = "ros2 bag play BAG, or a SequentialReader and publish(cdr) in a timer."


class PlayOptions(Player):
    """A player's options."""


class Recorder(_NotOffered):
    """A recorder."""

    instead = "ros2 bag record TOPIC, or a SequentialWriter in a subscription's callback."


class RecordOptions(Recorder):
    """A recorder's options."""


class Reindexer(_NotOffered):
    """A maker of metadata."""

    instead = "nothing is needed: the kit reads bags whose metadata.yaml is missing."


def bag_rewrite(*args: Any) -> None:
    """Refuse to convert bags."""
    raise BagError("The kit has no rosbag2_py.bag_rewrite. Instead: SequentialReader and SequentialWriter.")
