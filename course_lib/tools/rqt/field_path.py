"""Numbers in messages by their paths, like /joint_states/position[0], as rqt_plot names them."""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.messages import Message
from course_lib.ros.messages.definitions import PRIMITIVES, FieldDefinition, definition

_STEP = re.compile(r"(\w+)(?:\[(\d+)\])?")


@dataclass(frozen=True)
class FieldPath:
    """A number in the messages of a topic."""

    text: str
    topic: str
    type_name: str
    steps: tuple[tuple[str, int | None], ...]  # field, and index in it

    def read(self, message: Message) -> float:
        """Return the number; not a number where a list is shorter."""
        value: object = message
        for name, index in self.steps:
            value = getattr(value, name)
            if index is not None:
                if index >= len(value):  # type: ignore[arg-type]  # parse() has seen that it is a list
                    return float("nan")
                value = value[index]  # type: ignore[index]  # as above
        return float(value)  # type: ignore[arg-type]  # parse() has seen that it is a number


def parse(text: str, topics: Mapping[str, Sequence[str]]) -> FieldPath:
    """Read a path.

    Args:
        text: /topic/field/part[0].
        topics: The types of each topic.

    Raises:
        CourseError: With rqt_plot's words, and what may have been meant.
    """
    path = "/" + text.strip("/")
    fitting = [topic for topic in topics if f"{path}/".startswith(f"{topic}/")]
    if not fitting:
        raise CourseError(f"topic {path} does not exist{did_you_mean(path, topics)}")
    topic = max(fitting, key=len)
    type_name = topics[topic][0]
    words = path[len(topic) :].strip("/")
    here, steps, field = type_name, list[tuple[str, int | None]](), None
    for word in filter(None, words.split("/")):
        fields = {field.name: field for field in definition(here).fields} if here else {}
        step = _STEP.fullmatch(word)
        if step is None or step[1] not in fields:
            raise CourseError(
                f"{path}: {here or 'a number'} has no field {word!r}{did_you_mean(word, fields)}"
            )
        field, index = fields[step[1]], None if step[2] is None else int(step[2])
        _check_index(path, word, field, index)
        steps.append((field.name, index))
        here = field.base if field.is_message else ""
    if field is None or field.is_message or PRIMITIVES[field.base].python not in (bool, int, float):
        numbers = [f"{path}/{name}" for name in _numbers(here)] if here else []
        why = "is not a number" if steps else f'no field specified in topic name "{path}"'
        raise CourseError(
            f"{f'{path} ' if steps else ''}{why}. Numbers here: {', '.join(numbers) or 'none'}."
        )
    return FieldPath(path, topic, type_name, tuple(steps))


def _check_index(path: str, word: str, field: FieldDefinition, index: int | None) -> None:
    if index is None and field.container != "scalar":
        raise CourseError(f"{path}: {field.name} is a list. Say which of it, like {field.name}[0].")
    if index is not None and (field.container == "scalar" or 0 < field.size <= index):
        size = f"a list of {field.size}" if field.container == "array" else "no list"
        raise CourseError(f"{path}: there is no {word}, {field.name} is {size}.")


def _numbers(type_name: str, deep: int = 2) -> Iterator[str]:
    """Name the numbers in a message, lists with an index."""
    for field in definition(type_name).fields:
        name = field.name if field.container == "scalar" else f"{field.name}[0]"
        if field.is_message and deep:
            yield from (f"{name}/{inner}" for inner in _numbers(field.base, deep - 1))
        elif not field.is_message and PRIMITIVES[field.base].python in (bool, int, float):
            yield name
