"""Files that a crash leaves whole or not at all, and evidence as such a file."""

import os
from collections.abc import Sequence
from dataclasses import astuple
from pathlib import Path
from typing import Any

import msgpack

from course_lib.grading.evidence import Evidence
from course_lib.grading.judge import Run
from course_lib.grading.plain import plain

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
    rows = [{"hidden": run.hidden, **_evidence(run.evidence)} for run in runs]
    packed: bytes = msgpack.packb({"version": VERSION, "runs": rows}, use_bin_type=True)
    return packed


def _evidence(evidence: Evidence) -> dict[str, Any]:
    samples = [(s.stamp_ns, s.topic, s.type_name, s.cdr, s.node, astuple(s.qos)) for s in evidence.samples]
    return {
        "task": evidence.task,
        "scenario": evidence.scenario,
        "seconds": evidence.seconds,
        "samples": samples,
        "returns": list(evidence.returns),
        "output": evidence.output,
        "errors": list(evidence.errors),
        "stopped": evidence.stopped,
        "personal": plain(dict(evidence.personal)),
    }
