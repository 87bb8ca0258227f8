"""Evidence as a file: all that judging needs, so that it can be repeated without running anything."""

import gzip
from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import msgpack

from course_lib.errors import CourseError
from course_lib.grading.evidence import Evidence
from course_lib.grading.exercise_run import ExerciseRun
from course_lib.grading.jail.isolation import Isolation
from course_lib.grading.job import Step
from course_lib.grading.judge import Run
from course_lib.grading.runner import CellLog
from course_lib.ros.graph import Sample
from course_lib.ros.qos import Qos

VERSION = 2
LEVEL = 2  # of compression: a higher one takes longer than the run did


def pack(run: ExerciseRun) -> bytes:
    """All that came out of a submission: the same bytes for the same evidence."""
    content = {
        "version": VERSION,
        "isolation": run.isolation.layers,
        "log": run.log,
        "evidence": [one.evidence for one in run.runs],
    }
    return gzip.compress(msgpack.packb(content, default=_by_field), LEVEL, mtime=0)


def unpack(data: bytes, steps: Sequence[Step]) -> ExerciseRun:
    """What `pack` made, with the checks of today.

    Raises:
        CourseError: It is something else, or of other scenarios.
    """
    try:
        content = msgpack.unpackb(gzip.decompress(data), strict_map_key=False)
        if content["version"] != VERSION:
            raise ValueError(f"it is of version {content['version']}, expected {VERSION}")
        kept = {(row["task"], row["scenario"]): _evidence(row) for row in content["evidence"]}
        runs = [Run(s.scenario, kept[s.task.id, s.scenario.name], s.hidden) for s in steps]
        log, isolation = CellLog(**content["log"]), Isolation(tuple(content["isolation"]))
    except Exception as error:  # a file may hold anything
        raise CourseError(f"stored evidence can't be read ({error!r}): grade without --rejudge") from error
    return ExerciseRun((), tuple(runs), log, isolation)


def _by_field(data: Any) -> dict[str, Any]:
    """A dataclass as its fields, without what it has worked out from them."""
    return {field.name: getattr(data, field.name) for field in fields(data)}


def _evidence(row: dict[str, Any]) -> Evidence:
    samples = tuple(Sample(**{**sample, "qos": Qos(**sample["qos"])}) for sample in row["samples"])
    texts = {name: tuple(row[name]) for name in ("returns", "errors")}
    return Evidence(**{**row, **texts, "samples": samples})
