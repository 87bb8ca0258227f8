"""The evidence of a run, including launched nodes, and the verdicts of checks.

Evidence is plain data that is recorded in lock-step with robot time, so that the same code gives
the same evidence, and the same evidence the same score. Checks never see the student's objects:
they run in another process, after the student's process has ended.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from numbers import Real
from typing import TYPE_CHECKING, Any, TypeVar

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import START_NS, Sample

if TYPE_CHECKING:
    from course_lib.recording import Recording

# Remapping argument that renames a node, after the option `-r`.
NAME = "__node:="


@dataclass(frozen=True)
class StartedNode:
    """A node that a launch file started.

    Args:
        package: The package of the executable.
        executable: The name of the executable.
        words: The command line, including the arguments after --ros-args.
        death: The launch's error text if the process failed, or "".
    """

    package: str
    executable: str
    words: tuple[str, ...] = ()
    death: str = ""

    @property
    def name(self) -> str | None:
        """The node's new name, or None if it was not renamed."""
        names = [word.removeprefix(NAME) for word in self.words if word.startswith(NAME)]
        return names[-1] if names else None

    @property
    def options(self) -> dict[str, str]:
        """The program's own arguments as a dict from option to value."""
        words, options = self.arguments, dict[str, str]()
        for word, following in zip(words, (*words[1:], "--"), strict=False):
            option, is_assigned, value = word.partition("=")
            if word.startswith("-") and is_assigned:
                options[option] = value
            # A negative number begins with a single dash.
            elif word.startswith("-") and not following.startswith("--"):
                options[word] = following
        return options

    @property
    def arguments(self) -> tuple[str, ...]:
        """The program's own arguments."""
        end = self.words.index("--ros-args") if "--ros-args" in self.words else len(self.words)
        return self.words[:end]


@dataclass(frozen=True)
class OtherValue:
    """The nodes that the launch file starts with another value of one of its arguments."""

    argument: str
    value: str
    started: tuple[StartedNode, ...]


@dataclass(frozen=True)
class LaunchRecord:
    """A launch that was run.

    Args:
        defaults: Default value of each declared argument; None for an argument without a default.
        started: The nodes, in the order in which they were started.
        other_values: The nodes started with other values of the arguments.
        error: The error text of `ros2 launch`, or "".
    """

    defaults: Mapping[str, str | None] = field(default_factory=dict)
    started: tuple[StartedNode, ...] = ()
    other_values: tuple[OtherValue, ...] = ()
    error: str = ""

    def as_plain(self) -> dict[str, Any]:
        """Return the record as plain data, which a worker may send."""
        return {
            "launched": {
                "defaults": dict(self.defaults),
                "started": [_encode_node(node) for node in self.started],
                "others": [
                    [other.argument, other.value, list(map(_encode_node, other.started))]
                    for other in self.other_values
                ],
                "error": self.error,
            }
        }

    @classmethod
    def from_plain(cls, value: Any) -> LaunchRecord | None:
        """Decode a record, or return None if the value is not one.

        The value comes from a student's process, so that it may have any structure.
        """
        try:
            content = value["launched"]
            return cls(
                {
                    str(name): None if text is None else str(text)
                    for name, text in content["defaults"].items()
                },
                tuple(map(_decode_node, content["started"])),
                tuple(
                    OtherValue(str(argument), str(value), tuple(map(_decode_node, nodes)))
                    for argument, value, nodes in content["others"]
                ),
                str(content["error"]),
            )
        except (AttributeError, KeyError, TypeError, ValueError):
            return None


def _encode_node(node: StartedNode) -> list[Any]:
    return [node.package, node.executable, list(node.words), node.death]


def _decode_node(value: Any) -> StartedNode:
    package, executable, arguments, death = value
    return StartedNode(str(package), str(executable), tuple(map(str, arguments)), str(death))


Computed = TypeVar("Computed")
FORMAL_SHARE = 0.1  # fraction of a scenario's weight that its formal checks have
LARGE = 2_000_000  # [B] size of a message, some 100,000 points, above which messages take most of the time
LIGHT = 0.05  # factor on a check's weight if students can read its inputs


@dataclass(frozen=True)
class Evidence:
    """The messages, returned values, output and errors of one scenario of a task, as plain data.

    Args:
        task: The task's id.
        scenario: The scenario's name.
        seconds: The intended length of the scenario in robot time.
        samples: The samples that the student's nodes published.
        returns: The returned values of a function, or the one submitted value or string, as plain
            data.
        output: The printed text, truncated at the limit.
        errors: One sentence per exception of the student's code.
        stopped: The limit that ended the scenario early ("time", "memory", …), or "".
        personal: The student's personal values.
        checks: All checks of the scenario, as `all_checks` returns them: a check can then judge
            the marker that the others judge. Empty if a check is called on its own.
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
    checks: tuple[Check, ...] = field(default=(), compare=False, repr=False)
    # The decoded messages by topic, and the values of `compute_once` by function.
    _decoded: dict[str, list[tuple[float, Any]]] = field(
        default_factory=dict, init=False, compare=False, repr=False
    )
    _computed: dict[Callable[..., Any], Any] = field(
        default_factory=dict, init=False, compare=False, repr=False
    )

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
        """Return (time since the start [s], message) pairs of a topic, without other types."""
        from course_lib.ros.messages.definitions import field_definitions

        if topic not in self._decoded:
            known_types = field_definitions()
            messages = self._decoded[topic] = []
            for sample in self.samples:
                # Looking up an unknown type takes milliseconds, and there may be 100,000 samples of it.
                if sample.topic == topic and sample.type_name in known_types:
                    # A student's process sent the bytes, which need not be a valid message.
                    with suppress(Exception):
                        messages.append(((sample.stamp_ns - START_NS) / 1e9, sample.message()))
        return self._decoded[topic]

    def compute_once(self, make: Callable[[Evidence], Computed]) -> Computed:
        """Return `make(self)`, computed once and shared by all checks."""
        if make not in self._computed:
            self._computed[make] = make(self)
        found: Computed = self._computed[make]
        return found

    @cached_property
    def large_message(self) -> str:
        """A description of the largest message if it is larger than LARGE, else ""."""
        largest = max(self.samples, key=lambda sample: len(sample.cdr), default=None)
        if largest is None or len(largest.cdr) <= LARGE:
            return ""
        return f"a message on {largest.topic} holds {len(largest.cdr) / 1e6:.0f} MB"

    def release(self) -> None:
        """Discard decoded messages and computed values, which use ten times the memory of the samples."""
        self._decoded.clear()
        self._computed.clear()


@dataclass(frozen=True)
class Verdict:
    """The result of a check.

    Args:
        score: From 0 to 1.
        message: The reason with values, which a public check shows.
        mistake: The kind of mistake without values, which a hidden check shows.
        broken: The exception that a check raised, or "".
    """

    score: float
    message: str
    mistake: str = ""
    broken: str = ""


def passed(message: str) -> Verdict:
    """Return a verdict with the full score and a message."""
    return Verdict(1.0, message)


def failed(message: str, mistake: str) -> Verdict:
    """Return a verdict with score 0.

    Args:
        message: The reason with values, which a public check shows.
        mistake: The kind of mistake without values, which a hidden check shows.
    """
    return Verdict(0.0, message, mistake)


@dataclass(frozen=True)
class Origin:
    """The line of a check file that called a check function, with the arguments of the call."""

    check_function: str
    arguments: Mapping[str, Any]
    location: str  # like "exercises/checks/week01.py line 12"


@dataclass(frozen=True)
class Check:
    """A pure function from evidence to a verdict.

    Args:
        title: The title in tables.
        judge: Returns the verdict, which must depend on the evidence only.
        weight: Share of the task's points; 0 for a check that only reports.
        requires: Checks that must have the full score on the same evidence, else this check scores
            0.
        origin: The call that created it; None for a check that was built by hand.
    """

    title: str
    judge: Callable[[Evidence], Verdict]
    weight: float = 1.0
    requires: tuple[Check, ...] = ()
    origin: Origin | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        if not (isinstance(self.weight, Real) and 0 <= self.weight < math.inf):
            raise CourseError(
                f"the check {self.title!r} has the weight {self.weight!r}: expected a number >= 0"
            )

    def titled(self, title: str) -> Check:
        """Return the check with another title."""
        return replace(self, title=title)

    def worth(self, weight: float) -> Check:
        """Return the check with another weight; with 0 the check is only reported."""
        return replace(self, weight=weight)

    def requiring(self, *checks: Check) -> Check:
        """Return a check that scores only if `checks` have the full score.

        A correct rate, stamp or frame is worth nothing as long as the published shape is wrong.
        """
        return replace(self, requires=(*self.requires, *checks))


def all_checks(checks: Sequence[Check]) -> tuple[Check, ...]:
    """Return the checks and all checks that they require, without repetition.

    The weight of a check that others require is the sum of its own and theirs, because without it
    they score nothing.
    """
    checks_by_judge: dict[Callable[[Evidence], Verdict], Check] = {}

    def add(check: Check, weight: float) -> None:
        existing = checks_by_judge.get(check.judge)
        checks_by_judge[check.judge] = replace(check, weight=weight + (existing.weight if existing else 0.0))
        for required in check.requires:
            add(required, weight)

    for check in checks:
        add(check, check.weight)
    return tuple(checks_by_judge.values())


def with_formal(content: Sequence[Check], *formal: Check) -> tuple[Check, ...]:
    """Return content checks followed by formal checks: rate, stamps, frame.

    Args:
        content: The first one checks the shape; the formal checks require it.
        formal: Together they get a tenth of the total weight, whatever their own weights.
    """
    total_weight = sum(check.weight for check in content)
    each = total_weight * FORMAL_SHARE / (1 - FORMAL_SHARE) / max(len(formal), 1)
    return (*content, *(check.requiring(content[0]).worth(each) for check in formal))


def lightly_weighted(*checks: Check) -> tuple[Check, ...]:
    """Return the checks with a small part of their weight, for scenarios that students can read.

    Hidden scenarios judge the same requirements with other inputs, so that an answer that is
    hard-coded for the public inputs gets almost no points.
    """
    return tuple(check.worth(LIGHT * check.weight) for check in checks)
