"""Expectations on the text of a parameters file."""

from collections.abc import Iterable, Mapping
from typing import Any

from course_lib.grading.evidence import Evidence
from course_lib.grading.vocabulary.values import compare
from course_lib.grading.vocabulary.wording import Problem, word
from course_lib.ros.parameter_yaml import read_text

LONGEST = 10_000  # characters
EVERY_NODE = "/**"
NAMES = {bool: "bool", int: "integer", float: "double", str: "string", list: "list"}


@word("the parameters of {node}")
def expect_parameters(
    evidence: Evidence, node: str, values: Mapping[str, Any], *, call: int = 0
) -> Iterable[Problem]:
    """The returned text is a parameters file that gives a node these values, of these types."""
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
        kinds = f"the {NAMES[type(value)]} {value!r}, expected a {NAMES[type(expected)]}"
        return [Problem(f"{key} of {node} is {kinds}", "a parameter has the wrong type")]
    return compare(value, expected, 1e-9, "", f"{key} of {node}")
