"""Compression options of bags."""

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
    """Compression of a bag. The numbers of queues and threads have no effect on its content."""

    compression_format: str = ""
    compression_mode: CompressionMode = CompressionMode.NONE
    compression_queue_size: int = 1
    compression_threads: int = 0

    def checked(self) -> str:
        """Return the compressed units: files or messages.

        Raises:
            BagError: Nothing is compressed, or the format is unknown.
        """
        if self.compression_mode == CompressionMode.NONE:
            raise BagError("SequentialCompressionWriter requires a CompressionMode that is not NONE!")
        if self.compression_format not in FORMATS:
            raise BagError(
                f"There is no compression {self.compression_format!r}. Choose one of {', '.join(FORMATS)}."
            )
        return self.compression_mode.name.lower()


def compression_mode_from_string(compression_mode: str) -> CompressionMode:
    """Return the mode with this name, ignoring case. An empty name means NONE."""
    try:
        return CompressionMode[compression_mode.upper() or "NONE"]
    except KeyError:
        raise BagError(
            f"CompressionMode: {compression_mode!r} is not recognized. Choose NONE, FILE or MESSAGE."
        ) from None


def compression_mode_to_string(compression_mode: CompressionMode) -> str:
    """Return the name of a mode."""
    return CompressionMode(compression_mode).name
