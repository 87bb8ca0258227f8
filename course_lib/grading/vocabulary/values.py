"""Checks of returned values, strings and parameter files."""

import math
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

from course_lib.errors import format_count, join_words
from course_lib.grading.evidence import Evidence
from course_lib.grading.run.outcome import RAISED, plain
from course_lib.grading.vocabulary.check_function import (
    Problem,
    are_angles_close,
    check_function,
    describe_offset,
    format_number,
    is_close,
)
from course_lib.ros.programs.parameter_yaml import read_text

WRONG, WRONG_KIND = "a value is wrong", "a value is of the wrong kind"
# What to change in a value that is not a list, by a pattern of its repr.
_REMEDIES = [
    (r" generator'}$", ": put it into list( )"),
    (r"^{'object': 'a (frozen)?set'}$", ": a set has no order, write [ ] instead of { }"),
    (r"^{(?!'object': )", ": return the values alone, in order and without their names"),
    (r"^['\"]", ": return the values themselves, not a string of them"),
]
WRONG_ORDER, NOT_CALLED = "values are in the wrong order", "a value is a function that is not called"
NESTED_LENGTH = "a list in a list has the wrong length"
OTHER_UNIT = "a value is in another unit"
# Between m and mm, s and ms; m and cm, a fraction and percent; s and ns; colors up to 1 and to 255.
_UNIT_FACTORS = (1000, 100, 10**9, 255)
_INDEX = re.compile(
    r"(\[.*?\]) of (.*)", re.DOTALL
)  # matches the name of an item: its index, and the list's name
LONGEST = 10_000  # limit on the characters of a parameters file
EVERY_NODE = "/**"
NAMES = {bool: "bool", int: "integer", float: "double", str: "string", list: "list"}


@check_function("{name} is right")
def expect_value(
    evidence: Evidence,
    expected: Any,
    *,
    call: int = 0,
    tolerance: float = 1e-6,
    unit: str = "",
    name: str = "the value",
    parts: Sequence[str] = (),
    axes: str = "",
    angles: Collection[int] = (),
) -> Iterable[Problem]:
    """Expect the value `expected`, submitted or returned by the call with the index `call`.

    Numbers, strings, and lists or dicts of them can be compared; tuples, lists and arrays with
    equal values are equal. `parts` names the items of a list, ("size", "color"), or of each row of
    a list of rows; without names a message has their indices. The kind of mistake then ends with
    the part, "a value is wrong: the size", so that a task can have a hint for each.

    `axes` name the numbers of the innermost lists: with "x y z, red green blue alpha", messages say
    "z of the centre" and "red of the color" instead of "[2] of the centre" and "[0] of the color".

    `angles` are the indices of joint angles [rad] in a list: they are equal if they differ by a
    full turn, and a joint turns by one turn at most in each direction.
    """
    if call >= len(evidence.returns):
        return [Problem(f"{name} is missing: nothing was returned", "a value is missing")]
    if evidence.returns[call] == RAISED:
        return [Problem(f"{name} is missing: the call raised an exception", "a value is missing")]
    value, right = evidence.returns[call], plain(expected)
    if isinstance(value, list) and isinstance(right, list) and len(value) == len(right):
        value = [
            wanted if index in angles and _is_same_joint_angle(item, wanted, tolerance) else item
            for index, (item, wanted) in enumerate(zip(value, right, strict=True))
        ]
    if parts and _are_rows(value, parts) and _are_rows(right, parts) and len(value) == len(right):
        rows = enumerate(zip(value, right, strict=True))
        return [
            problem
            for index, (row, expected_row) in rows
            for problem in _compare_components(
                row, expected_row, parts, axes, tolerance, unit, f"row {index} of {name}"
            )
        ]
    if parts and _are_rows([value, right], parts):
        return _compare_components(value, right, parts, axes, tolerance, unit, name)
    return compare(value, right, tolerance, unit, name, axes)


def _are_rows(rows: Any, parts: Sequence[str]) -> bool:
    """Return whether a value is a list of lists that have an item for each part."""
    return isinstance(rows, list) and all(isinstance(row, list) and len(row) == len(parts) for row in rows)


def _compare_components(
    row: list[Any],
    expected: list[Any],
    parts: Sequence[str],
    axes: str,
    tolerance: float,
    unit: str,
    name: str,
) -> Iterator[Problem]:
    if problem := _order_problem(row, expected, tolerance, name):
        yield problem
        return
    for item, expected_item, part in zip(row, expected, parts, strict=True):
        for problem in compare(item, expected_item, tolerance, unit, f"the {part} of {name}", axes):
            # The part is an item of a list. A task may have a hint for it. Otherwise the hint for
            # the kind alone is used.
            kind = problem.mistake.replace("a list has the wrong length", NESTED_LENGTH)
            yield Problem(problem.message, f"{kind}: the {part}")


@check_function("{name} contains the answer")
def expect_text(
    evidence: Evidence, *any_of: str, name: str = "your answer", but_not: Sequence[str] = ()
) -> Iterable[Problem]:
    """Expect one of the phrases `any_of` in the string, ignoring case, spaces and punctuation.

    The string must not contain any of the wrong answers `but_not`, so that a list of all answers
    does not pass.
    """
    text = evidence.returns[0] if evidence.returns else None
    if not isinstance(text, str) or not text.strip():
        return [
            Problem(f"{name} is {_shorten(text)}, expected a string", "the answer is empty or not a string")
        ]
    normalized = f" {_normalize(text)} "
    if wrong := [phrase for phrase in but_not if f" {_normalize(phrase)} " in normalized]:
        message = f"{name} is {_shorten(text)}: {wrong[0]!r} is not right, give one answer"
        return [Problem(message, "the answer is not right")]
    if any(f" {_normalize(phrase)} " in normalized for phrase in any_of):
        return []
    return [Problem(f"{name} is {_shorten(text)}: that is not the answer", "the answer is not right")]


@check_function("its length")
def expect_length(evidence: Evidence, fewest: int, most: int) -> Iterable[Problem]:
    """Expect a string of `fewest` to `most` words."""
    text = evidence.returns[0] if evidence.returns else None
    count = len(text.split()) if isinstance(text, str) else 0
    if fewest <= count <= most:
        return []
    return [Problem(f"{count} words, expected {fewest} to {most}", "the text has the wrong length")]


def _is_same_joint_angle(value: Any, expected: float, tolerance: float) -> bool:
    """Return whether two angles [rad], within one turn, are the same position of a joint."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return abs(value) <= math.tau and are_angles_close(value, expected, tolerance)


def compare(
    value: Any, expected: Any, tolerance: float, unit: str, name: str, axes: str = ""
) -> Iterator[Problem]:
    """Compare plain data recursively and yield the problems of the innermost values.

    `axes` name the numbers of the innermost lists, "x y z"; a comma separates names for lists of
    another length.
    """
    actual = f"{name} is {_shorten(value)}"
    match expected, value:
        case list(), list():
            yield from _compare_lists(value, expected, tolerance, unit, name, axes)
        case list(), _:
            expected_text = f"a list of {len(expected)}" if expected else "an empty list"
            remedy = _remedy(value, expected)
            yield Problem(f"{actual}, expected {expected_text}{remedy}", WRONG_KIND)
        case dict(), {"object": str(kind)} if len(value) == 1 and "object" not in expected:
            yield Problem(f"{name} is {kind}, expected a dict", WRONG_KIND)
        case dict(), dict():
            for key in expected:
                if key in value:
                    yield from compare(
                        value[key], expected[key], tolerance, unit, _item_name(name, key), axes
                    )
                else:
                    yield Problem(f"{name} has no {key!r}", "a key is missing")
        case dict(), _:
            yield Problem(f"{actual}, expected a dict", WRONG_KIND)
        case ((bool() | str() | None), _):
            bare = value.strip() if isinstance(value, str) and value != expected else value
            # True == 1 in Python, so the types are compared, too.
            if (type(bare), bare) != (type(expected), expected):
                yield Problem(f"{actual}, expected {expected!r}", WRONG)
        case _, {"object": str(kind)} if kind.endswith(("method", "function")):
            yield Problem(f"{actual}, expected a number: are its ( ) missing?", NOT_CALLED)
        case _, [int() | float(), *more]:
            column = "take it out of its list, or call .ravel() on a column of numpy"
            remedy = "is a matrix multiplied with * instead of @?" if more else column
            yield Problem(f"{actual}, expected a number: {remedy}", WRONG_KIND)
        case _, (bool() | str() | None | list() | dict()):
            yield Problem(f"{actual}, expected a number", WRONG_KIND)
        case _ if not is_close(value, expected, tolerance):
            yield _number_problem(value, expected, unit, name)


def _remedy(value: Any, expected: list[Any]) -> str:
    """Return what to change in a value that is not a list, or ""."""
    has_pairs = bool(expected) and all(isinstance(row, list) and len(row) == 2 for row in expected)
    if isinstance(value, dict) and "object" not in value and has_pairs:
        return ": a list of pairs is needed instead of a dict"
    return next((text for kind, text in _REMEDIES if re.search(kind, repr(value))), "")


def _compare_lists(
    value: list[Any], expected: list[Any], tolerance: float, unit: str, name: str, axes: str
) -> Iterator[Problem]:
    if len(value) != len(expected):
        message = f"{name} has {format_count(len(value), 'item')}, expected {len(expected) or 'none'}"
        items = _shorten(_round_numbers(value))
        # The beginning of a long table does not help.
        if value and not (items.endswith("...") and any(isinstance(item, list | dict) for item in value)):
            message = f"{message}: {items}"
        is_nested = len(value) == 1 and isinstance(value[0], list) and len(value[0]) == len(expected)
        # A row of a table is a list, too.
        if is_nested and not any(isinstance(item, list) for item in expected):
            message = f"{message}: it is a list in a list, leave out the outer [ ]"
        if _INDEX.match(name):
            yield Problem(message, NESTED_LENGTH)
        else:
            yield Problem(message, "a list has the wrong length")
        return
    is_nested = any(isinstance(item, list) for item in expected)
    groups = [] if is_nested else [group.split() for group in axes.split(",")]
    own_axes = next((group for group in groups if len(group) == len(expected)), [])
    if problem := _order_problem(value, expected, tolerance, name, own_axes):
        yield problem
        return
    names = [f"{axis} of {name}" for axis in own_axes]
    names = names or [_item_name(name, index) for index in range(len(expected))]
    for item, expected_item, item_name in zip(value, expected, names, strict=True):
        yield from compare(item, expected_item, tolerance, unit, item_name, axes)


def _order_problem(
    value: list[Any],
    expected: list[Any],
    tolerance: float,
    name: str,
    axes: Sequence[str] = (),
) -> Problem | None:
    """Return the problem of a list with the expected numbers or strings in a different order.

    `axes` name its numbers, if they have names.
    """
    if not {type(item) for item in (*value, *expected)} <= {int, float, str}:
        return None
    pairs = zip(value, expected, strict=True)
    wrong_indices = [index for index, pair in enumerate(pairs) if _is_different(*pair, tolerance)]
    if not wrong_indices:
        return None
    is_opposite = not any(
        _is_different(*pair, tolerance) for pair in zip(value, reversed(expected), strict=True)
    )
    if not is_opposite and not _is_permutation(value, expected, tolerance):
        return None
    actual, expected_text = map(_shorten, map(_round_numbers, (value, expected)))
    order = "the order is the other way round" if is_opposite else "the order is another one"
    if axes and len(wrong_indices) == 2:
        order = f"{join_words([axes[index] for index in wrong_indices])} are exchanged"
    return Problem(f"{name} is {actual}, expected {expected_text}: {order}", WRONG_ORDER)


def _round_numbers(value: Any) -> Any:
    """Return a value for display, with the numbers in its lists rounded to four digits."""
    if isinstance(value, list):
        return [_round_numbers(item) for item in value]
    return float(f"{value:.4g}") if isinstance(value, float) else value


def _is_permutation(value: list[Any], expected: list[Any], tolerance: float) -> bool:
    """Return whether two lists have the same items, which all differ from each other."""
    left = list(expected)
    for member in value:
        place = next((n for n, item in enumerate(left) if not _is_different(member, item, tolerance)), None)
        if place is None:
            return False
        del left[place]
    # If items are equal, such as the zeros of a color, a wrong list with the same items is more often
    # a wrong result than a wrong order.
    return len({str(item) for item in expected}) == len(expected)


def _is_different(value: float | str, expected: float | str, tolerance: float) -> bool:
    if isinstance(value, str) or isinstance(expected, str):
        return value != expected
    return not is_close(value, expected, tolerance)


def _item_name(name: str, index: object) -> str:
    """Return the name of an item: "[2] of a bar", and "[1][2] of a bar" if it is nested."""
    outer = _INDEX.match(name)
    return f"{outer[1]}[{index!r}] of {outer[2]}" if outer else f"[{index!r}] of {name}"


def _number_problem(value: float, expected: float, unit: str, name: str) -> Problem:
    if isinstance(value, int) and isinstance(expected, int) and not unit:
        relation = "too much" if value > expected else "too little"
        offset = f"{abs(value - expected)} {relation}"
        return Problem(f"{name} is {value}, expected {expected}: {offset}", WRONG)
    texts = [format_number(value, unit), format_number(expected, unit)]
    if texts[0] == texts[1]:
        # The difference is smaller than the last decimal that is usually displayed.
        texts = [f"{number:.6g}{unit and ' ' + unit}" for number in (value, expected)]
    actual = f"{name} is {texts[0]}, expected {texts[1]}"
    if not math.isfinite(value):
        return Problem(actual, "a value is not a finite number")
    if unit == "rad" and abs(expected) > 1e-3 and math.isclose(math.radians(value), expected, rel_tol=1e-3):
        return Problem(f"{actual}: is it in degrees instead of radians?", "a value is in degrees")
    if unit == "rad" and math.isclose(abs(value - expected), math.pi, abs_tol=1e-3):
        return Problem(f"{actual}: half a turn off", "an angle is wrong by half a turn")
    for factor in _UNIT_FACTORS if abs(expected) > 1e-9 else ():
        if math.isclose(value, expected * factor, rel_tol=1e-3):
            return Problem(f"{actual}: {factor} times too much", OTHER_UNIT)
        if math.isclose(value * factor, expected, rel_tol=1e-3):
            return Problem(f"{actual}: {factor} times too little", OTHER_UNIT)
    for digits in (1, 2, 3) if math.isclose(value, expected, rel_tol=0.01) else ():
        if value == round(expected, digits) != round(value):
            actual = f"{actual}: rounded to {format_count(digits, 'digit')}"
            return Problem(actual, "a value is rounded")
    offset = f"{actual}: {describe_offset(value, expected, 'too much', 'too little', unit)}"
    # A small whole number is more often computed than rounded.
    if (
        abs(value) >= 10
        and value == round(value)
        and expected != round(expected)
        and abs(value - expected) < 1
    ):
        return Problem(offset, "a value is rounded")
    mistake = "a value has the wrong sign" if math.isclose(value, -expected, rel_tol=1e-3) else WRONG
    return Problem(offset, mistake)


def _normalize(text: str) -> str:
    return " ".join(re.findall(r"\w+", text.casefold()))


def _shorten(value: Any) -> str:
    is_object = isinstance(value, dict) and list(value) == ["object"]
    text = str(value["object"]) if is_object else repr(value)
    return text if len(text) <= 80 else f"{text[:77]}..."


def describe_missing_text(value: Any, kind: str) -> str:
    """Return a sentence about a value that was returned instead of a file's text."""
    if value is None or value == RAISED or (isinstance(value, str) and not value.strip()):
        return f"no {kind} was returned"
    is_object = isinstance(value, dict) and list(value) == ["object"]
    name = value["object"] if is_object else f"a {type(value).__name__}"
    return f"{name} was returned, expected the text of the {kind}, a string"


@check_function("the parameters of {node}")
def expect_parameters(
    evidence: Evidence,
    node: str,
    values: Mapping[str, Any],
    *,
    call: int = 0,
    unchanged: Mapping[str, Any] | None = None,
) -> Iterable[Problem]:
    """Expect a parameters file that sets these values, with these types, for a node.

    `unchanged` has the defaults of all parameters that the file must not change. It may repeat
    them.
    """
    text = evidence.returns[call] if call < len(evidence.returns) else None
    if not isinstance(text, str) or not text.strip() or len(text) > LONGEST:
        message = describe_missing_text(text, "parameters file")
        return [Problem(message, "there is no parameters file")]
    if "\n" not in text and text.strip().endswith((".yaml", ".yml")):
        message = f"{text.strip()!r} is the name of a file, expected its text"
        return [Problem(message, "there is no parameters file")]
    try:
        sections = read_text(text)
    except ValueError as error:
        return [Problem(f"ROS rejects the file: {error}", "the parameters file cannot be read")]
    parameters: dict[str, Any] = {}
    for name, section in sections:
        if name in (EVERY_NODE, node):
            parameters |= section
    problems = [
        problem
        for key, expected in values.items()
        for problem in _check_parameter(node, key, parameters, expected, sections)
    ]
    for key, default in (unchanged or {}).items():
        if key not in values and parameters.get(key, default) != default:
            message = f"{key} of {node} is {parameters[key]!r}, expected its default, {default!r}"
            problems.append(Problem(message, "a parameter does not keep its default"))
    return problems


def _check_parameter(
    node: str,
    key: str,
    parameters: Mapping[str, Any],
    expected: Any,
    sections: Sequence[tuple[str, Mapping[str, Any]]],
) -> Iterable[Problem]:
    if key not in parameters:
        elsewhere = [name for name, section in sections if key in section]
        if elsewhere:
            own = f"only for {join_words(elsewhere)}"
        elif parameters:
            own = f"only {join_words(list(parameters))}"
        else:
            own = f"whose nodes are {join_words([name for name, _ in sections])}"
        message = f"there is no {key} for {node} in the file, {own}"
        return [Problem(message, "a parameter is missing in the file")]
    value = parameters[key]
    if type(value) is not type(expected):
        type_text = NAMES[type(expected)]
        kinds = (
            f"the {NAMES[type(value)]} {value!r}, expected {'an' if type_text[0] == 'i' else 'a'} {type_text}"
        )
        return [Problem(f"{key} of {node} is {kinds}", "a parameter has the wrong type")]
    return compare(value, expected, 1e-9, "", f"{key} of {node}")
