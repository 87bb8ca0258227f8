"""What a submission used of the machine; kept beside its evidence, as it differs from run to run."""

import json
import os
import sys
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path

_RSS_PER_MB = 1e6 if sys.platform == "darwin" else 1e3  # getrusage counts bytes there, kB elsewhere


@dataclass(frozen=True)
class Usage:
    """CPU of all processes together [s], and the most memory that one of them held [MB].

    Where files are on a disk, also the most that they took [MB]; else the kernel bounds them.
    """

    cpu_seconds: float = 0.0
    memory_megabytes: float = 0.0
    files_megabytes: float = 0.0

    def __add__(self, other: "Usage") -> "Usage":
        memory = max(self.memory_megabytes, other.memory_megabytes)
        files = max(self.files_megabytes, other.files_megabytes)
        return Usage(round(self.cpu_seconds + other.cpu_seconds, 3), memory, files)

    def fills(self, megabytes: float) -> bool:
        """Return whether all files take far more than the limit of a single one."""
        return self.files_megabytes > 2 * megabytes

    def as_json(self) -> str:
        """Write it as a file, or into a message."""
        return json.dumps(asdict(self))


def wait_any_child() -> Usage:
    """Wait for any child to end, and return what it and those that it waited for have used.

    Raises:
        ChildProcessError: There is none.
    """
    _, _, used = os.wait3(0)
    return Usage(round(used.ru_utime + used.ru_stime, 3), round(used.ru_maxrss / _RSS_PER_MB, 1))


def usage_path(out: Path, key: str) -> Path:
    """Where it is kept, by the key of the evidence."""
    return out / "evidence" / f"{key}.usage.json"


def read_usage(out: Path, key: str) -> Usage | None:
    """What a run used; None if that is not known."""
    with suppress(OSError, ValueError, TypeError):
        return Usage(**json.loads(usage_path(out, key).read_text(encoding="utf-8")))
    return None
