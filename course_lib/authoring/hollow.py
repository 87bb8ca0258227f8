"""Ways to take the content out of what a right solution published: what is left is worth next to nothing."""

from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from course_lib.grading.evidence import Evidence
from course_lib.ros.graph import Sample
from course_lib.ros.messages import serialize, type_name

HEADER = "std_msgs/msg/Header"
ORIENTATION = "geometry_msgs/msg/Quaternion"  # its default is no turn, not 0
NAMED = ("type", "ns", "id", "name", "joint_names", "child_frame_id", "action", "lifetime")
Change = Callable[[Any], None]


@dataclass(frozen=True)
class Hollowing:
    """One way to publish nothing at the right times.

    Args:
        name: For people.
        left: What is left of the samples.
        remedy: What an author does where that still earns points.
    """

    name: str
    left: Callable[[Sequence[Sample]], list[Sample]]
    remedy: str = "let these checks require the one of the content: check.requiring(content)"

    def of(self, evidence: Evidence) -> Evidence:
        """Return the same evidence with nothing but what is left."""
        return replace(evidence, samples=tuple(self.left(evidence.samples)))


def _parts(message: Any) -> list[Any]:
    """The messages in the fields of a message."""
    values = [getattr(message, name) for name in message._KINDS]
    nested = [item for value in values for item in (value if isinstance(value, list) else [value])]
    return [item for item in nested if hasattr(item, "_KINDS")]


def _keep(message: Any, *, names: Sequence[str]) -> None:
    """Set all fields to their defaults, except headers and the fields in `names`; lists keep their length."""
    if type_name(message) == HEADER:
        return
    default = type(message)()
    for name in message._KINDS:
        value = getattr(message, name)
        nested = isinstance(value, list) and any(hasattr(item, "_KINDS") for item in value)
        if not nested and not hasattr(value, "_KINDS") and name not in names:
            setattr(message, name, _blank(value, getattr(default, name)))
    for part in _parts(message):
        _keep(part, names=names)


def _blank(value: Any, default: Any) -> Any:
    """As many zeros as there were numbers; for texts, lists and single numbers their default."""
    if isinstance(value, np.ndarray):
        return np.zeros_like(value)
    return array(value.typecode, [0] * len(value)) if isinstance(value, array) else default


def _zero(message: Any) -> None:
    """Set all floating point numbers to 0."""
    if type_name(message) in (HEADER, ORIENTATION):
        return
    for name in message._KINDS:
        value = getattr(message, name)
        if isinstance(value, float):
            setattr(message, name, 0.0)
        elif isinstance(value, array) and value.typecode in "fd":
            setattr(message, name, array(value.typecode, [0.0] * len(value)))
    for part in _parts(message):
        _zero(part)


def _set(message: Any, *, field: str, parts: str) -> None:
    """Set these parts of a field of all markers to 0."""
    for part in parts:
        if field in message._KINDS and part in getattr(message, field)._KINDS:
            setattr(getattr(message, field), part, 0.0)
    for item in _parts(message):
        _set(item, field=field, parts=parts)


def _changed(samples: Sequence[Sample], change: Change) -> list[Sample]:
    made = []
    for sample in samples:
        message = sample.message()
        change(message)
        made.append(replace(sample, cdr=serialize(message)))
    return made


def _last(samples: Sequence[Sample]) -> list[Sample]:
    return [sample for sample in samples if sample.stamp_ns == samples[-1].stamp_ns]


def _hollow(name: str, change: Change) -> Hollowing:
    return Hollowing(name, partial(_changed, change=change))


ALL_THE_TIME = (
    "let these checks require that all messages come: check.requiring(expect_throughout(topic).worth(0)), "
    "or expect_topic(topic, type, at_least=5)"
)
HOLLOWINGS = (
    _hollow("headers only", partial(_keep, names=())),
    _hollow("types, names and headers only", partial(_keep, names=NAMED)),
    _hollow("zeros for numbers", _zero),
    _hollow("invisible: alpha 0", partial(_set, field="color", parts="a")),
    _hollow("invisible: scale 0", partial(_set, field="scale", parts="xyz")),
    Hollowing("one message at the end", _last, ALL_THE_TIME),
)
