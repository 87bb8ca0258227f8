"""The decorator that defines a word of the vocabulary, with its comparisons and phrases."""

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

from course_lib.errors import CourseError
from course_lib.grading.evidence import Check, Evidence, Origin, Verdict, passed
from course_lib.grading.task import My, resolve
from course_lib.ros.messages import type_name

KINDS: Mapping[Any, tuple[type, str]] = {
    str: (str, "a text"),
    int: (Integral, "a whole number"),
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


def refuse_misfits(word: str, parameters: Iterable[Parameter], values: Mapping[str, Any]) -> None:
    """Refuse arguments that no evidence can be compared with.

    Args:
        word: The word's name.
        parameters: Of the word.
        values: The arguments, by the parameters' names.

    Raises:
        CourseError: One is of another kind, or has another length; names it and what was expected.
    """
    for parameter in parameters:
        value, name = values[parameter.name], parameter.name
        if value is None or isinstance(value, My) or parameter.kind is Parameter.VAR_POSITIONAL:
            continue
        expected = _kind_expected(parameter.annotation, value) or _length_expected(name, value)
        if expected:
            raise CourseError(f"{word}: {name}={value!r}, expected {expected}")


def _kind_expected(annotation: Any, value: Any) -> str:
    """Return the words for the kind that a value has not, or ""."""
    either = get_args(annotation) if isinstance(annotation, UnionType) else (annotation,)
    kinds = [one for one in either if one is not type(None)]
    kind, words = KINDS.get(kinds[0], (object, "")) if len(kinds) == 1 else (object, "")
    return "" if isinstance(value, kind) else words


def _length_expected(name: str, value: Any) -> str:
    """Return the words for the length that a value has not, or ""."""
    lengths, words = LENGTHS.get(name, ((), ""))
    if not lengths or (isinstance(value, Sized) and not isinstance(value, str) and len(value) in lengths):
        return ""
    return f"{' or '.join(map(str, lengths))} numbers ({words})"


MOST_SHOWN = 3  # problems in one message
LONGEST = 1000  # characters of it: it may name what a student's code made up
LARGE = 1e6  # from here on numbers are written like 1.5e+08
Given = ParamSpec("Given")


@dataclass
class Problem(Exception):  # noqa: N818  raised only where nothing more can be looked at
    """One thing that is wrong: with values for public checks, and the kind of mistake for hidden ones."""

    message: str
    mistake: str


Find = Callable[Concatenate[Evidence, Given], Iterable[Problem]]


def word(title: str) -> Callable[[Find[Given]], Callable[Given, Check]]:
    """Return a decorator that turns a function which finds problems into a word for check files.

    The word takes the function's arguments without the evidence, and gives a check that passes where no
    problem is listed or raised. `my(...)` among the arguments becomes the student's own value.

    Args:
        title: Of the check; arguments' names in braces, {given} for those that were given by keyword.
    """

    def word_of(find: Find[Given]) -> Callable[Given, Check]:
        signature = inspect.signature(find)

        @wraps(find)
        def expect(*args: Given.args, **kwargs: Given.kwargs) -> Check:
            def judge(evidence: Evidence) -> Verdict:
                own_args, own_kwargs = resolve((args, kwargs), evidence.personal)
                try:
                    return _verdict(list(find(evidence, *own_args, **own_kwargs)))
                except Problem as problem:
                    return _verdict([problem])

            try:
                values = signature.bind(None, *args, **kwargs)
            except TypeError as error:
                raise TypeError(f"{find.__name__}: {error}") from error
            values.apply_defaults()
            refuse_misfits(find.__name__, list(signature.parameters.values())[1:], values.arguments)
            called = sys._getframe(1)
            place = f"{called.f_code.co_filename} line {called.f_lineno}"
            origin = Origin(find.__name__, values.arguments, place)
            full = title.format(**values.arguments, given=listed(list(kwargs)) or "is there")
            return Check(full, judge, origin=origin)

        _describe(expect, signature)
        return expect

    return word_of


def _describe(expect: Any, signature: inspect.Signature) -> None:
    """Show in `help(word)` what an author calls: without the evidence, and with a check as the result."""
    asked = list(signature.parameters.values())[1:]
    expect.__signature__ = signature.replace(parameters=asked, return_annotation=Check)
    expect.__annotations__ = {one.name: one.annotation for one in asked} | {"return": Check}
    expect.__doc__ = re.sub(r"\n +evidence: .*", "", expect.__doc__ or "")


def _verdict(problems: Sequence[Problem]) -> Verdict:
    if not problems:
        return passed("as expected")
    message = "; ".join(problem.message for problem in problems[:MOST_SHOWN])
    if len(problems) > MOST_SHOWN:
        message += f"; and {len(problems) - MOST_SHOWN} more"
    message = message if len(message) <= LONGEST else f"{message[:LONGEST]} …"
    return Verdict(0.0, message, "; ".join(dict.fromkeys(problem.mistake for problem in problems)))


def close(value: float, expected: float, tolerance: float) -> bool:
    """Return whether two numbers agree; never for NaN."""
    return abs(value - expected) <= tolerance


def close_angles(value: float, expected: float, tolerance: float) -> bool:
    """Return whether two angles [rad] agree, whole turns apart."""
    return close(math.remainder(value - expected, math.tau), 0.0, tolerance)


def yaw_of(x: float, y: float, z: float, w: float) -> float:
    """Return the turn of a quaternion about z, [rad]."""
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def number(value: float, unit: str = "") -> str:
    """Return a number for people: at least two decimals, as many as a small value needs, few digits."""
    if abs(value) >= LARGE and math.isfinite(value):
        return f"{value:.6g}{unit and ' ' + unit}"
    small = 5e-5 <= abs(value) < 0.1
    return f"{value:z.{4 if small else 2}f}{unit and ' ' + unit}"


def numbers(values: Iterable[float]) -> str:
    """Return a few numbers in brackets."""
    return f"({', '.join(number(value) for value in values)})"


def off_by(value: float, expected: float, more: str, less: str, unit: str = "m") -> str:
    """Return the difference with its direction, "0.30 m too low"; also for NaN and infinity."""
    if not math.isfinite(value):
        return "not at a place" if math.isnan(value) else "infinitely far off"
    return f"{number(abs(value - expected), unit)} {more if value > expected else less}"


def heard(evidence: Evidence, topic: str, *types: str) -> list[tuple[float, Any]]:
    """Return ([s] since the start, message) of all messages on a topic.

    Args:
        evidence: What was published.
        topic: Its full name.
        types: Only messages of these types, "nav_msgs/msg/Path"; any message if none is given.

    Raises:
        Problem: There is no such message; it names the type that came instead.
    """
    came = evidence.messages(topic)
    found = [(at, message) for at, message in came if type_name(message) in types] if types else came
    if found:
        return found
    if topic not in evidence.topics:
        raise nothing_on(evidence, topic)
    carried, expected = evidence.topics[topic], " or ".join(types) or "a message"
    if carried in types or not types:
        raise Problem(f"{topic} carries bytes that are not {expected}", "a message cannot be read")
    raise Problem(f"{topic} carries {carried}, expected {expected}", "a topic has the wrong message type")


def nothing_on(evidence: Evidence, topic: str) -> Problem:
    """Return the problem of a silent topic; it names those with messages."""
    others = f"only on {', '.join(sorted(evidence.topics))}" if evidence.topics else "nor on any other topic"
    message = f"nothing was published on {topic} in {evidence.seconds:g} s, {others}"
    return Problem(message, "nothing was published on an expected topic")


def listed(items: Sequence[str]) -> str:
    """Return a few words as English has them: "a, b and c"."""
    return " and ".join(filter(None, [", ".join(items[:-1]), *items[-1:]]))
