"""Compression of bags."""

from dataclasses import dataclass
from enum import IntEnum

from rosbag2_py._storage import BagError

FORMATS = ("zstd",)


class CompressionMode(IntEnum):
    """The parts of a bag that are compressed."""

    NONE = 0
    FILE = 1
    MESSAGE = 2


NONE, FILE, MESSAGE = CompressionMode


@dataclass
class CompressionOptions:
    """A compression; queues and threads change nothing in a bag."""

    compression_format: str = ""
    compression_mode: CompressionMode = CompressionMode.NONE
    compression_queue_size: int = 1
    compression_threads: int = 0

    def checked(self) -> str:
        """Return the part that is compressed; raises a BagError for none and for unknown formats."""
        if self.compression_mode == CompressionMode.NONE:
            raise BagError("SequentialCompressionWriter requires a CompressionMode that is not NONE!")
        if self.compression_format not in FORMATS:
            raise BagError(
                f"There is no compression {self.compression_format!r}. Choose one of {', '.join(FORMATS)}."
            )
        return self.compression_mode.name.lower()


def compression_mode_from_string(compression_mode: str) -> CompressionMode:
    """Return a mode by its name in any letters; an empty one is NONE."""
    try:
        return CompressionMode[compression_mode.upper() or "NONE"]
    except KeyError:
        raise BagError(
            f"CompressionMode: {compression_mode!r} is not recognized. Choose NONE, FILE or MESSAGE."
        ) from None


def compression_mode_to_string(compression_mode: CompressionMode) -> str:
    """Return the name of a mode."""
    return CompressionMode(compression_mode).name
