"""Validation of ROS names in check files: message types, fields and marker types."""

import ast
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path

from course_lib.authoring.rehearsal import count_options, with_option
from course_lib.errors import CourseError, did_you_mean, location_of
from course_lib.grading.evidence import Origin
from course_lib.grading.inputs import build, personal_values
from course_lib.grading.submissions.notebook import CodeCell
from course_lib.grading.task import Message, Scenario, Task
from course_lib.ros.messages.definitions import definition

# The columns of the table: the heading and the requirement.
ASPECTS = {
    "files": "course.toml, check files and answers can be read",
    "fields": "message types and fields in checks and inputs exist; no topic of an input is misspelt",
    "solution": "the solution has full marks under every personal option",
    "stub": "the empty exercise has no points, and its errors state what is missing",
    "empty": "a publisher without content has at most a tenth of the points",
    "second": "an alternative correct answer has full marks",
    "wrong": "wrong answers and mutants fail with a message about the mistake, and crashing answers fail",
    "can fail": "every check fails for at least one answer",
    "quiz": "each question has one right answer, and all questions of the lessons exist",
    "lesson": "lessons run without errors; lesson, exercise and solution follow the rules",
    "fresh": "the exercise is generated from the current solution",
}


@dataclass(frozen=True)
class Flaw:
    """A flaw in the files of a week.

    Args:
        aspect: A key of ASPECTS.
        text: What was found and what was expected.
        place: The file, with the line if it is known.
    """

    aspect: str
    text: str
    place: str = ""

    def __str__(self) -> str:
        return f"{self.place}: {self.text}" if self.place else self.text


NAME = re.compile(r"/?[A-Za-z]\w*(/\w+)*")
# Minimum similarity of two names for one to count as a misspelling of the other.
SIMILAR = 0.75
# Topics that nodes subscribe to although their code does not contain the names.
IMPLICIT_TOPICS = ("/tf", "/tf_static", "/clock")
MARKER = "visualization_msgs/msg/Marker"


def invalid_messages(task: Task, scenarios: Sequence[Scenario], path: Path) -> Iterator[Flaw]:
    """Yield a flaw for each input and each message of the expected picture that does not fit its type."""
    messages = [message for scenario in scenarios for message in scenario.inputs]
    found = dict.fromkeys(
        problem
        for row in range(count_options([task]))
        for message in (*messages, *task.ghost)
        if (problem := _problem(message, with_option(task, row)))
    )
    for text in found:
        yield Flaw("fields", f"{task.id}: {text}", location_of(path, _last_quoted_name(text)))


def names_in(cells: Iterable[str]) -> frozenset[str]:
    """Return the strings in the code that may be topic or node names, without the leading slash."""
    trees = [CodeCell(1, cell, True).tree for cell in cells]
    nodes = (node for tree in trees for node in ast.walk(tree))
    texts = (node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str))
    return frozenset(text.strip("/") for text in texts if NAME.fullmatch(text))


def misspelled_topics(
    task: Task, scenarios: Iterable[Scenario], names: Collection[str], path: Path
) -> Iterator[Flaw]:
    """Yield a flaw for each input topic that is not in the solution although a similar name is.

    Other names are not flaws, because a TransformListener subscribes to topics that its code does
    not mention, and a name may be composed at run time.
    """
    for topic in dict.fromkeys(message.topic for one in scenarios for message in one.inputs):
        name = topic.strip("/").removesuffix("/set_parameters")
        parts = {name, *name.split("/")}
        near = get_close_matches(name, names, n=1, cutoff=SIMILAR)
        if parts.isdisjoint(names) and f"/{name}" not in IMPLICIT_TOPICS and near:
            text = f"the solution does not use the input topic {topic!r}. Did you mean {near[0]}?"
            yield Flaw("fields", f"{task.id}: {text}", location_of(path, f'"{topic}"'))


def _problem(message: Message, task: Task) -> str:
    # For a service, the fields are those of the request.
    is_request = "/srv/" in message.type_name
    type_name = f"{message.type_name}_Request" if is_request else message.type_name
    try:
        build(replace(message, type_name=type_name), personal_values(task, None))
    except CourseError as error:
        return str(error)
    return ""


def _last_quoted_name(text: str) -> str:
    """Return the last quoted name, which in error messages of Python and ROS is the misspelled one."""
    return f'"{text.rsplit(chr(39), 2)[-2]}"' if text.count("'") > 1 else ""


def misspelled_names(
    task: Task, scenarios: Iterable[Scenario], types: Mapping[tuple[str, str], str]
) -> Iterator[Flaw]:
    """Yield a flaw for each message type, field or marker type in a check that does not exist.

    Args:
        task: The task.
        scenarios: The task's scenarios.
        types: The message type that the solution publishes, by task and topic.
    """
    checks = [check for scenario in scenarios for check in scenario.checks]
    for check in (one for whole in checks for one in (whole, *whole.requires)):
        if check.origin is not None and (text := _misspelling(task, check.origin, types)):
            yield Flaw("fields", f"{task.id}: {text}", check.origin.place)


def _misspelling(task: Task, origin: Origin, types: Mapping[tuple[str, str], str]) -> str:
    given = origin.arguments
    wanted = given.get("type")
    try:
        if origin.check_function == "expect_topic" and isinstance(wanted, str):
            definition(wanted)
        elif origin.check_function in ("expect_marker", "expect_marker_count") and isinstance(wanted, str):
            known = definition(MARKER).constants
            if wanted not in known:
                raise CourseError(f"a marker has no type {wanted!r}{did_you_mean(wanted, known)}")
        elif origin.check_function == "expect_message" and (sent := types.get((task.id, given["topic"]))):
            for dotted in given["fields"]:
                _check_field(sent, dotted)
    except CourseError as error:
        return f"{origin.check_function}: {error}"
    return ""


def _check_field(type_name: str, dotted: str) -> None:
    """Resolve a dotted field name through the message types.

    Raises:
        CourseError: A message type does not have the field.
    """
    at = type_name
    for part in dotted.split("."):
        if part.isdecimal():
            continue
        fields = {field.name: field for field in definition(at).fields} if "/" in at else {}
        if part not in fields:
            known = did_you_mean(part, fields) or f"; it has {', '.join(fields) or 'no fields'}"
            raise CourseError(f"{at} has no field {part!r} ({dotted!r}){known}")
        at = fields[part].base
