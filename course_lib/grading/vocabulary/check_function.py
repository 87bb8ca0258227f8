"""The decorator that defines a check function, with its comparisons and phrases.

A check file calls check functions such as `expect_marker(...)`. Each returns a `Check`, whose title
is formatted from the arguments and whose messages exist in two versions: with values for public
checks, and as a kind of mistake for hidden checks, which must not reveal the expected values.
"""

import inspect
import math
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence, Sized
from dataclasses import dataclass
from functools import wraps
from inspect import Parameter
from numbers import Integral, Real
from types import UnionType
from typing import Any, Concatenate, ParamSpec, get_args

from course_lib.errors import CourseError, did_you_mean, join_words
from course_lib.grading.evidence import Check, Evidence, Origin, Verdict, passed
from course_lib.grading.task import My, resolve
from course_lib.ros.messages import type_name

KINDS: Mapping[Any, tuple[type, str]] = {
    str: (str, "a string"),
    int: (Integral, "an integer"),
    float: (Real, "a number"),
    bool: (bool, "True or False"),
}
LENGTHS: Mapping[str, tuple[tuple[int, ...], str]] = {
    "position": ((3,), "x, y, z"),
    "translation": ((3,), "x, y, z"),
    "scale": ((3,), "x, y, z"),
    "center": ((2,), "x, y"),
    "color": ((3, 4), "red, green, blue and perhaps alpha"),
}
# Possible strings by check function and parameter.
CHOICES: dict[tuple[str, str], Sequence[str]] = {}


def check_arguments(name: str, parameters: Iterable[Parameter], values: Mapping[str, Any]) -> None:
    """Reject arguments that cannot be compared with any evidence.

    Args:
        name: Name of the check function.
        parameters: Its parameters.
        values: The arguments by parameter name.

    Raises:
        CourseError: An argument has the wrong type or length; the message states the expected
            value.
    """
    for parameter in parameters:
        value, key = values[parameter.name], parameter.name
        if value is None or isinstance(value, My) or parameter.kind is Parameter.VAR_POSITIONAL:
            continue
        annotation = parameter.annotation
        either = get_args(annotation) if isinstance(annotation, UnionType) else (annotation,)
        kinds = [kind for kind in either if kind is not type(None)]
        kind, type_text = KINDS.get(kinds[0], (object, "")) if len(kinds) == 1 else (object, "")
        lengths, length_text = LENGTHS.get(key, ((), ""))
        has_length = isinstance(value, Sized) and not isinstance(value, str) and len(value) in lengths
        expected = ""
        if not isinstance(value, kind):
            expected = type_text
        elif lengths and not has_length:
            expected = f"{' or '.join(map(str, lengths))} numbers ({length_text})"
        choices = CHOICES.get((name, key), (value,))
        if not expected and value not in choices:
            expected = f"one of {', '.join(choices)}{did_you_mean(value, choices)}"
        if not expected and key == "topic" and not value.startswith("/"):
            expected = f"a name that begins with a slash, '/{value}'"
        if expected:
            raise CourseError(f"{name}: {key}={value!r}, expected {expected}")


MOST_SHOWN = 3  # maximum number of problems in a message
# The message may contain text from the student's code, so its length is limited.
LONGEST = 1000
LARGE = 1e6  # threshold for formatting numbers like 1.5e+08
Given = ParamSpec("Given")


@dataclass
class Problem(Exception):  # noqa: N818
    """A problem in the evidence, raised if nothing more can be checked.

    `message` has values and is shown by public checks. `mistake` is the kind of mistake, without
    values, which hidden checks show.
    """

    message: str
    mistake: str


Find = Callable[Concatenate[Evidence, Given], Iterable[Problem]]


def check_function(title: str) -> Callable[[Find[Given]], Callable[Given, Check]]:
    """Return a decorator that turns a function which finds problems into a check function.

    The check function takes the same arguments except the evidence, and returns a check that passes
    if no problem is returned or raised. `my(...)` in the arguments is replaced by the student's
    personal value.
    """

    def decorate(find: Find[Given]) -> Callable[Given, Check]:
        signature = inspect.signature(find)

        @wraps(find)
        def expect(*args: Given.args, **kwargs: Given.kwargs) -> Check:
            def judge(evidence: Evidence) -> Verdict:
                own_args, own_kwargs = resolve((args, kwargs), evidence.personal)
                try:
                    return _combine(list(find(evidence, *own_args, **own_kwargs)))
                except Problem as problem:
                    return _combine([problem])

            try:
                values = signature.bind(None, *args, **kwargs)
            except TypeError as error:
                raise TypeError(f"{find.__name__}: {error}") from error
            values.apply_defaults()
            check_arguments(find.__name__, list(signature.parameters.values())[1:], values.arguments)
            called = sys._getframe(1)
            location = f"{called.f_code.co_filename} line {called.f_lineno}"
            origin = Origin(find.__name__, values.arguments, location)
            full = title.format(**values.arguments, given=join_words(list(kwargs)) or "is there")
            return Check(full, judge, origin=origin)

        # `help` shows the author's signature: without the evidence, returning a check.
        parameters = list(signature.parameters.values())[1:]
        shown: Any = expect
        shown.__signature__ = signature.replace(parameters=parameters, return_annotation=Check)
        shown.__annotations__ = {p.name: p.annotation for p in parameters} | {"return": Check}
        # The lines of an entry that continue it are indented further.
        shown.__doc__ = re.sub(r"\n( +)evidence: .*(\n\1 +\S.*)*", "", expect.__doc__ or "")
        return expect

    return decorate


def _combine(problems: Sequence[Problem]) -> Verdict:
    if not problems:
        return passed("as expected")
    messages = list(dict.fromkeys(problem.message for problem in problems))
    message = "; ".join(messages[:MOST_SHOWN])
    if len(messages) > MOST_SHOWN:
        message += f"; and {len(messages) - MOST_SHOWN} more"
    message = message if len(message) <= LONGEST else f"{message[:LONGEST]} …"
    return Verdict(0.0, message, "; ".join(dict.fromkeys(problem.mistake for problem in problems)))


def is_close(value: float, expected: float, tolerance: float) -> bool:
    """Return whether two numbers agree within the tolerance; false for NaN."""
    return abs(value - expected) <= tolerance


def are_angles_close(value: float, expected: float, tolerance: float) -> bool:
    """Return whether two angles [rad] agree within the tolerance, modulo full turns."""
    return is_close(math.remainder(value - expected, math.tau), 0.0, tolerance)


def yaw_of(x: float, y: float, z: float, w: float) -> float:
    """Return the yaw of a quaternion of any length, its rotation about z [rad]."""
    return math.atan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)


def format_number(value: float, unit: str = "") -> str:
    """Format a number for a message: two decimals, four if small, few digits if large."""
    if abs(value) >= LARGE and math.isfinite(value):
        return f"{value:.6g}{unit and ' ' + unit}"
    small = 5e-5 <= abs(value) < 0.1
    return f"{value:z.{4 if small else 2}f}{unit and ' ' + unit}"


def format_angle(value: float) -> str:
    """Format an angle [rad], followed by its value in degrees, which is easier to imagine."""
    return f"{format_number(value, 'rad')} ({math.degrees(value):z.0f}°)"


def format_numbers(values: Iterable[float]) -> str:
    """Format numbers as a list in parentheses."""
    return f"({', '.join(format_number(value) for value in values)})"


def describe_offset(value: float, expected: float, more: str, less: str, unit: str = "m") -> str:
    """Describe a difference with its direction, "0.30 m too low".

    NaN and infinity are accepted, too.
    """
    if not math.isfinite(value):
        return "not a number" if math.isnan(value) else "infinitely far off"
    return f"{format_number(abs(value - expected), unit)} {more if value > expected else less}"


def received_messages(evidence: Evidence, topic: str, *types: str) -> list[tuple[float, Any]]:
    """Return (time since the start [s], message) for each message on a topic.

    Args:
        evidence: The evidence of the scenario.
        topic: The full topic name.
        types: Accepted message types, "nav_msgs/msg/Path"; all types if none is given.

    Raises:
        Problem: There is no such message; the problem states the type that was published instead.
    """
    messages = evidence.messages(topic)
    matching = (
        [(at, message) for at, message in messages if type_name(message) in types] if types else messages
    )
    if matching:
        return matching
    if topic not in evidence.topics:
        raise silent_topic_problem(evidence, topic)
    actual_type, expected = evidence.topics[topic], " or ".join(types) or "a message"
    if actual_type in types or not types:
        raise Problem(f"{topic} carries bytes that are not {expected}", "a message cannot be read")
    raise Problem(f"{topic} carries {actual_type}, expected {expected}", "a topic has the wrong message type")


def name_hint(frame: str, expected: str) -> str:
    """Return the end of a message about a frame that has nearly the expected name, or ""."""
    if frame.startswith("/") or frame.strip("/") == expected:
        return ": a frame's name has no slash"
    if frame.strip() == expected:
        return ": there is a space too many"
    return ": upper and lower case differ" if frame.lower() == expected.lower() else ""


def silent_topic_problem(evidence: Evidence, topic: str) -> Problem:
    """Return the problem of a topic without messages, which lists the topics with messages."""
    elsewhere = (
        f"only on {', '.join(sorted(evidence.topics))}" if evidence.topics else "nor on any other topic"
    )
    message = f"nothing was published on {topic} in {evidence.seconds:g} s, {elsewhere}"
    if topic in evidence.topics:
        message = f"only empty messages were published on {topic} in {evidence.seconds:g} s"
    return Problem(message, "nothing was published on an expected topic")
