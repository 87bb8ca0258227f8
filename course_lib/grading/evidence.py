"""Evidence of a run, checks, and their verdicts."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from numbers import Real
from typing import TYPE_CHECKING, Any, TypeVar

from course_lib.errors import CourseError
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Sample

if TYPE_CHECKING:
    from course_lib.recording import Recording

Found = TypeVar("Found")
FORMAL_SHARE = 0.1  # of the weight of a scenario's checks
LARGE = 2_000_000  # [B] of a message, some 100,000 points: from here on they are what takes the time
LIGHT = 0.05  # of a check's weight, where students can read its inputs


@dataclass(frozen=True)
class Evidence:
    """Messages, returned values, output and errors of one scenario of one task, all of it data.

    Args:
        task: The task's id.
        scenario: The scenario's name.
        seconds: Robot time that the scenario was to last.
        samples: What the student's side published.
        returns: Returned values of a function, or the one value or text handed in; plain data.
        output: What was printed, cut at the limit.
        errors: One sentence per exception of the student's code.
        stopped: Which limit ended it early ("time", "memory", …), or "".
        personal: The student's own values.
    """

    task: str
    scenario: str
    seconds: float
    samples: tuple[Sample, ...] = ()
    returns: tuple[Any, ...] = ()
    output: str = ""
    errors: tuple[str, ...] = ()
    stopped: str = ""
    personal: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def recording(self) -> Recording:
        """The samples as a recording."""
        from course_lib.recording import Recording

        return Recording(self.samples)

    @cached_property
    def topics(self) -> dict[str, str]:
        """Message types by topic."""
        return {sample.topic: sample.type_name for sample in self.samples}

    def messages(self, topic: str) -> list[tuple[float, Any]]:
        """Return ([s] since the start, message) pairs of one topic, without bytes of another type."""
        if topic not in self._decoded:
            pairs = [(s.stamp_ns, _decode(s)) for s in self.samples if s.topic == topic]
            self._decoded[topic] = [((ns - START_NS) / 1e9, m) for ns, m in pairs if m is not None]
        return self._decoded[topic]

    def once(self, make: Callable[[Evidence], Found]) -> Found:
        """Return what `make` finds in this evidence; it is called once, however many checks ask for it."""
        if make not in self._found:
            self._found[make] = make(self)
        found: Found = self._found[make]
        return found

    @cached_property
    def large_message(self) -> str:
        """The topic and the size of the largest message, where it is LARGE, else ""."""
        largest = max(self.samples, key=lambda sample: len(sample.cdr), default=None)
        if largest is None or len(largest.cdr) <= LARGE:
            return ""
        return f"a message on {largest.topic} holds {len(largest.cdr) / 1e6:.0f} MB"

    def release(self) -> None:
        """Drop what was decoded and found: it takes ten times the memory of the bytes."""
        self._decoded.clear()
        self._found.clear()

    @cached_property
    def _decoded(self) -> dict[str, list[tuple[float, Any]]]:
        return {}

    @cached_property
    def _found(self) -> dict[Callable[..., Any], Any]:
        return {}


def _decode(sample: Sample) -> Any:
    from course_lib.ros.messages.definitions import typestore

    if sample.type_name not in typestore().fielddefs:
        return None  # at once: to look for it takes milliseconds, and there may be 100,000 of them
    try:
        return sample.message()
    except Exception:  # the bytes come from a student's process: they may be anything, and no message then
        return None


@dataclass(frozen=True)
class Verdict:
    """A check's answer.

    Args:
        score: From 0 to 1.
        message: The reason; a public check shows it.
        mistake: The kind of mistake, without values; a hidden check shows it.
        broken: The exception of a check that could not judge.
    """

    score: float
    message: str
    mistake: str = ""
    broken: str = ""


def passed(message: str) -> Verdict:
    """Return the full score with a message."""
    return Verdict(1.0, message)


def failed(message: str, mistake: str) -> Verdict:
    """Return no score.

    Args:
        message: The reason with values, which a public check shows.
        mistake: The kind of mistake without values, which a hidden check shows.
    """
    return Verdict(0.0, message, mistake)


@dataclass(frozen=True)
class Origin:
    """The place in a check file where a word was written, and what was given to it."""

    word: str
    arguments: Mapping[str, Any]
    place: str  # "exercises/checks/week01.py line 12"


@dataclass(frozen=True)
class Check:
    """A pure function from evidence to a verdict.

    Args:
        title: In tables.
        judge: Returns the verdict; it must not depend on anything but the evidence.
        weight: Share of the task's points; 0 only reports.
        requires: Checks that must have full score on the same evidence, otherwise this check scores 0.
        origin: Where it was written; None for a check of one's own.
    """

    title: str
    judge: Callable[[Evidence], Verdict]
    weight: float = 1.0
    requires: tuple[Check, ...] = ()
    origin: Origin | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if not (isinstance(self.weight, Real) and 0 <= self.weight < math.inf):
            raise CourseError(f"the check {self.title!r} is worth {self.weight!r}: expected 0 or more")

    def titled(self, title: str) -> Check:
        """Return the check under another title."""
        return replace(self, title=title)

    def worth(self, weight: float) -> Check:
        """Return the check with another share of the task's points; 0 only reports."""
        return replace(self, weight=weight)

    def requiring(self, *checks: Check) -> Check:
        """Return a check that scores only where `checks` have full score.

        A rate, a stamp or a frame is worth nothing as long as the published shape is wrong.
        """
        return replace(self, requires=(*self.requires, *checks))


def with_formal(content: Sequence[Check], *formal: Check) -> tuple[Check, ...]:
    """Return the checks of content, followed by the formal ones: rate, stamps, frame.

    Args:
        content: The first of them is the shape without which nothing formal scores.
        formal: Get a tenth of the whole weight together, whatever they weigh each.
    """
    whole = sum(check.weight for check in content)
    each = whole * FORMAL_SHARE / (1 - FORMAL_SHARE) / max(len(formal), 1)
    return (*content, *(check.requiring(content[0]).worth(each) for check in formal))


def lightly(*checks: Check) -> tuple[Check, ...]:
    """Return the checks at a small part of their weight, for a scenario whose inputs students can read.

    Hidden scenarios judge the same requirements with other inputs. An answer that was written for the public
    inputs alone gets next to nothing then.
    """
    return tuple(check.worth(LIGHT * check.weight) for check in checks)
