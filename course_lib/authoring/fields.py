"""Names of ROS in check files: message types, fields, types of markers."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from course_lib.authoring.flaw import Flaw
from course_lib.authoring.rehearsal import options, with_option
from course_lib.errors import CourseError, did_you_mean, place_of
from course_lib.grading.evidence import Origin
from course_lib.grading.personal import build, personal_values
from course_lib.grading.task import Message, Scenario, Task
from course_lib.ros.messages.definitions import definition

MARKER = "visualization_msgs/msg/Marker"


def unbuildable(task: Task, scenarios: Sequence[Scenario], path: Path) -> Iterator[Flaw]:
    """Yield each input, and each message of the expected picture, that is no message of its type."""
    messages = [message for scenario in scenarios for message in scenario.inputs]
    found = dict.fromkeys(
        problem
        for row in range(options([task]))
        for message in (*messages, *task.ghost)
        if (problem := _problem(message, with_option(task, row)))
    )
    for text in found:
        yield Flaw("fields", f"{task.id}: {text}", place_of(path, _named(text)))


def _problem(message: Message, task: Task) -> str:
    is_request = "/srv/" in message.type_name  # a service is called
    type_name = f"{message.type_name}_Request" if is_request else message.type_name
    try:
        build(replace(message, type_name=type_name), personal_values(task, None))
    except CourseError as error:
        return str(error)
    return ""


def _named(text: str) -> str:
    """Return the last name between quotes, which is the misspelt one in Python's and ROS's texts."""
    return f'"{text.rsplit(chr(39), 2)[-2]}"' if text.count("'") > 1 else ""


def misspelt(
    task: Task, scenarios: Iterable[Scenario], types: Mapping[tuple[str, str], str]
) -> Iterator[Flaw]:
    """Yield each name in a check that ROS does not have.

    Args:
        task: The task.
        scenarios: Its scenarios with their checks.
        types: By task and topic, the type of message that the solution publishes.
    """
    checks = [check for scenario in scenarios for check in scenario.checks]
    for check in (one for whole in checks for one in (whole, *whole.requires)):
        if check.origin is not None and (text := _misspelling(task, check.origin, types)):
            yield Flaw("fields", f"{task.id}: {text}", check.origin.place)


def _misspelling(task: Task, origin: Origin, types: Mapping[tuple[str, str], str]) -> str:
    given = origin.arguments
    wanted = given.get("type")
    try:
        if origin.word == "expect_topic" and isinstance(wanted, str):
            definition(wanted)
        elif origin.word in ("expect_marker", "expect_marker_count") and isinstance(wanted, str):
            _constant(wanted)
        elif origin.word == "expect_message" and (sent := types.get((task.id, given["topic"]))):
            for dotted in given["fields"]:
                _field(sent, dotted)
    except CourseError as error:
        return f"{origin.word}: {error}"
    return ""


def _constant(name: str) -> None:
    known = definition(MARKER).constants
    if name not in known:
        raise CourseError(f"a marker has no type {name!r}{did_you_mean(name, known)}")


def _field(type_name: str, dotted: str) -> None:
    """Follow a field with dots through the types of messages.

    Raises:
        CourseError: One of them has no such field.
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
