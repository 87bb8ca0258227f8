"""Expectations on returned values and texts."""

import math
import re
from typing import Any

import numpy as np

from course_lib.grading.evidence import Check, Evidence
from course_lib.grading.vocabulary.wording import Problem, check_of, close, number, off_by


def expect_value(
    expected: Any, *, call: int = 0, tolerance: float = 1e-6, unit: str = "", name: str = "the value"
) -> Check:
    """The value handed in, or returned by the `call`-th call, equals `expected`.

    Numbers, texts, and lists or dicts of them; a tuple, list or array of equal values are the same.
    """
    expectation = {"expected": expected, "call": call, "tolerance": tolerance, "unit": unit, "name": name}
    return check_of(f"{name} is right", expectation, _value)


def expect_text(*any_of: str, name: str = "your answer") -> Check:
    """One of these phrases occurs in the text; case, spaces and punctuation do not matter."""
    return check_of(f"{name} says it", {"any_of": any_of, "name": name}, _text)


def expect_no_error() -> Check:
    """Nothing was raised. Weighs 0 unless `.worth(...)` says else: a stub must not earn points by it."""
    return check_of("runs without an error", {}, _no_error).worth(0)


def _value(
    evidence: Evidence, expected: Any, call: int, tolerance: float, unit: str, name: str
) -> list[Problem]:
    if call >= len(evidence.returns):
        return [Problem(f"{name} is missing: nothing came back", "a value is missing")]
    return compare(evidence.returns[call], expected, tolerance, unit, name)


def compare(value: Any, expected: Any, tolerance: float, unit: str, name: str) -> list[Problem]:
    """Compare plain data with what was expected: the problems, those of the innermost values."""
    if isinstance(expected, np.ndarray):
        expected = expected.tolist()
    if isinstance(expected, (list, tuple)):
        return _sequence(value, list(expected), tolerance, unit, name)
    if isinstance(expected, dict):
        return _dict(value, expected, tolerance, unit, name)
    if isinstance(expected, bool) or not isinstance(expected, (int, float)):
        same = type(value) is type(expected) and value == expected
        if same or (isinstance(value, str) and isinstance(expected, str) and value.strip() == expected):
            return []
        return [Problem(f"{name} is {_short(value)}, expected {expected!r}", "a value is wrong")]
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return [Problem(f"{name} is {_short(value)}, expected a number", "a value is of the wrong kind")]
    if close(value, expected, tolerance):
        return []
    came = f"{name} is {number(value, unit)}, expected {number(expected, unit)}"
    if not math.isfinite(value):
        return [Problem(came, "a value is no finite number")]
    return [
        Problem(
            f"{came}: {off_by(value, expected, 'too much', 'too little', unit)}", _mistake(value, expected)
        )
    ]


def _mistake(value: float, expected: float) -> str:
    same_size = math.isclose(value, -expected, rel_tol=1e-3)
    return "a value has the wrong sign" if same_size else "a value is wrong"


def _sequence(value: Any, expected: list[Any], tolerance: float, unit: str, name: str) -> list[Problem]:
    if not isinstance(value, list):
        message = f"{name} is {_short(value)}, expected a list of {len(expected)}"
        return [Problem(message, "a value is of the wrong kind")]
    if len(value) != len(expected):
        message = f"{name} has {len(value)} items, expected {len(expected)}"
        return [Problem(message, "a list has the wrong length")]
    pairs = enumerate(zip(value, expected, strict=True))
    return [p for i, (v, e) in pairs for p in compare(v, e, tolerance, unit, f"{name}[{i}]")]


def _dict(value: Any, expected: dict[str, Any], tolerance: float, unit: str, name: str) -> list[Problem]:
    if not isinstance(value, dict):
        return [Problem(f"{name} is {_short(value)}, expected a dict", "a value is of the wrong kind")]
    problems = []
    for key, item in expected.items():
        if key in value:
            problems += compare(value[key], item, tolerance, unit, f"{name}[{key!r}]")
        else:
            problems.append(Problem(f"{name} has no {key!r}", "a key is missing"))
    return problems


def _text(evidence: Evidence, any_of: tuple[str, ...], name: str) -> list[Problem]:
    text = evidence.returns[0] if evidence.returns else None
    if not isinstance(text, str) or not text.strip():
        return [Problem(f"{name} is {_short(text)}, expected a text", "the answer is empty or no text")]
    if any(f" {_words(phrase)} " in f" {_words(text)} " for phrase in any_of):
        return []
    return [Problem(f"{name} is {_short(text)}: that is not it", "the answer is not right")]


def _words(text: str) -> str:
    return " ".join(re.findall(r"\w+", text.casefold()))


def _no_error(evidence: Evidence) -> list[Problem]:
    return [Problem(error, "the code raises an exception") for error in evidence.errors]


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."
