"""Evidence as bytes."""

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import msgpack

from course_lib.grading.judge import Run

VERSION = 1


def evidence_bytes(runs: Sequence[Run]) -> bytes:
    """All that came out of a submission, as msgpack: the same bytes for the same evidence."""
    rows = [{"hidden": run.hidden, "evidence": run.evidence} for run in runs]
    packed: bytes = msgpack.packb({"version": VERSION, "runs": rows}, default=_by_field)
    return packed


def _by_field(data: Any) -> dict[str, Any]:
    """A dataclass as its fields, without what it has worked out from them."""
    return {field.name: getattr(data, field.name) for field in fields(data)}
