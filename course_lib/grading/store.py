"""Files that a crash leaves whole or not at all, and evidence as such a file."""

import os
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import msgpack

from course_lib.grading.judge import Run

VERSION = 1


def write_whole(path: Path, data: bytes) -> None:
    """Write a file aside, on the disk for certain, then rename it; its folder is made."""
    path.parent.mkdir(parents=True, exist_ok=True)
    draft = path.with_name(f".{path.name}.{os.getpid()}")
    with draft.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    draft.replace(path)


def evidence_bytes(runs: Sequence[Run]) -> bytes:
    """All that came out of a submission, as msgpack: the same bytes for the same evidence."""
    rows = [{"hidden": run.hidden, "evidence": run.evidence} for run in runs]
    packed: bytes = msgpack.packb({"version": VERSION, "runs": rows}, default=_by_field)
    return packed


def _by_field(data: Any) -> dict[str, Any]:
    """A dataclass as its fields, without what it has worked out from them."""
    return {field.name: getattr(data, field.name) for field in fields(data)}
