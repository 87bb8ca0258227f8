"""Checks on returned values, texts and parameter files."""

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from course_lib.grading.evidence import Evidence
from course_lib.grading.run.outcome import RAISED, plain
from course_lib.grading.vocabulary.wording import Problem, close, number, off_by, word
from course_lib.ros.parameter_yaml import read_text

WRONG, WRONG_KIND = "a value is wrong", "a value is of the wrong kind"
LONGEST = 10_000  # characters
EVERY_NODE = "/**"
NAMES = {bool: "bool", int: "integer", float: "double", str: "string", list: "list"}


@word("{name} is right")
def expect_value(
    evidence: Evidence,
    expected: Any,
    *,
    call: int = 0,
    tolerance: float = 1e-6,
    unit: str = "",
    name: str = "the value",
) -> Iterable[Problem]:
    """Expect the value `expected`, handed in or returned by the `call`-th call.

    Numbers, texts, and lists or dicts of them; a tuple, list or array of equal values are the same.
    """
    if call >= len(evidence.returns):
        return [Problem(f"{name} is missing: nothing came back", "a value is missing")]
    if evidence.returns[call] == RAISED:
        return [Problem(f"{name} is missing: the call raised an exception", "a value is missing")]
    return compare(evidence.returns[call], plain(expected), tolerance, unit, name)


@word("{name} says it")
def expect_text(evidence: Evidence, *any_of: str, name: str = "your answer") -> Iterable[Problem]:
    """Expect one of the phrases `any_of` in the text; case, spaces and punctuation do not matter."""
    text = evidence.returns[0] if evidence.returns else None
    if not isinstance(text, str) or not text.strip():
        return [Problem(f"{name} is {_short(text)}, expected a text", "the answer is empty or no text")]
    if any(f" {_words(phrase)} " in f" {_words(text)} " for phrase in any_of):
        return []
    return [Problem(f"{name} is {_short(text)}: that is not it", "the answer is not right")]


@word("its length")
def expect_length(evidence: Evidence, fewest: int, most: int) -> Iterable[Problem]:
    """Expect a text of `fewest` to `most` words."""
    text = evidence.returns[0] if evidence.returns else None
    count = len(text.split()) if isinstance(text, str) else 0
    if fewest <= count <= most:
        return []
    return [Problem(f"{count} words, expected {fewest} to {most}", "the text has another length")]


def compare(value: Any, expected: Any, tolerance: float, unit: str, name: str) -> Iterator[Problem]:
    """Compare plain data with what was expected: the problems, those of the innermost values."""
    came = f"{name} is {_short(value)}"
    match expected, value:
        case list(), list() if len(value) != len(expected):
            message = f"{name} has {len(value)} items, expected {len(expected)}"
            yield Problem(message, "a list has the wrong length")
        case list(), list():
            for index, pair in enumerate(zip(value, expected, strict=True)):
                yield from compare(*pair, tolerance, unit, _inside(name, index))
        case list(), _:
            yield Problem(f"{came}, expected a list of {len(expected)}", WRONG_KIND)
        case dict(), {"object": str(kind)} if len(value) == 1 and "object" not in expected:
            yield Problem(f"{name} is {kind}, expected a dict", WRONG_KIND)
        case dict(), dict():
            for key in expected:
                if key in value:
                    yield from compare(value[key], expected[key], tolerance, unit, _inside(name, key))
                else:
                    yield Problem(f"{name} has no {key!r}", "a key is missing")
        case dict(), _:
            yield Problem(f"{came}, expected a dict", WRONG_KIND)
        case str(), str() if value.strip() == expected:
            return
        case ((bool() | str() | None), _):
            if type(value) is not type(expected) or value != expected:
                yield Problem(f"{came}, expected {expected!r}", WRONG)
        case _, (bool() | str() | None | list() | dict()):
            yield Problem(f"{came}, expected a number", WRONG_KIND)
        case _ if not close(value, expected, tolerance):
            yield _other_number(value, expected, unit, name)


def _inside(name: str, index: object) -> str:
    """Return the name of an item: "[2] of a bar", and one within "[1] of a bar" is "[1][2] of a bar"."""
    outer = re.match(r"(\[.*?\]) of (.*)", name, re.DOTALL)
    return f"{outer[1]}[{index!r}] of {outer[2]}" if outer else f"[{index!r}] of {name}"


def _other_number(value: float, expected: float, unit: str, name: str) -> Problem:
    came = f"{name} is {number(value, unit)}, expected {number(expected, unit)}"
    if not math.isfinite(value):
        return Problem(came, "a value is not a finite number")
    mistake = "a value has the wrong sign" if math.isclose(value, -expected, rel_tol=1e-3) else WRONG
    return Problem(f"{came}: {off_by(value, expected, 'too much', 'too little', unit)}", mistake)


def _words(text: str) -> str:
    return " ".join(re.findall(r"\w+", text.casefold()))


def _short(value: Any) -> str:
    is_object = isinstance(value, dict) and list(value) == ["object"]
    text = str(value["object"]) if is_object else repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."


@word("the parameters of {node}")
def expect_parameters(
    evidence: Evidence, node: str, values: Mapping[str, Any], *, call: int = 0
) -> Iterable[Problem]:
    """Expect a parameters file that sets these values, of these types, for a node."""
    text = evidence.returns[call] if call < len(evidence.returns) else None
    if not isinstance(text, str) or not text.strip() or len(text) > LONGEST:
        return [Problem("no text of a parameters file came back", "there is no parameters file")]
    try:
        sections = read_text(text)
    except ValueError as error:
        return [Problem(f"ROS says of the file: {error}", "the parameters file cannot be read")]
    found: dict[str, Any] = {}
    for name, given in sections:
        if name in (EVERY_NODE, node):
            found |= given
    return [problem for key, expected in values.items() for problem in _misfit(node, key, found, expected)]


def _misfit(node: str, key: str, found: Mapping[str, Any], expected: Any) -> Iterable[Problem]:
    if key not in found:
        return [Problem(f"{node} gets no {key} from the file", "a parameter is missing in the file")]
    value = found[key]
    if type(value) is not type(expected):
        wanted = NAMES[type(expected)]
        kinds = f"the {NAMES[type(value)]} {value!r}, expected {'an' if wanted[0] == 'i' else 'a'} {wanted}"
        return [Problem(f"{key} of {node} is {kinds}", "a parameter has the wrong type")]
    return compare(value, expected, 1e-9, "", f"{key} of {node}")
