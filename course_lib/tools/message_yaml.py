"""Types and messages on the command line: found by name, filled from YAML."""

from collections.abc import Mapping, Sequence
from typing import Any

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.messages import RosMessage, type_name
from course_lib.ros.messages.conversions import SetTime, set_fields
from course_lib.ros.messages.definitions import type_names


def kind_of(find: Any, type_name: str, folder: str) -> Any:
    """Return the class of a message, service or action type; as in ROS its folder may be missing."""
    package, *rest = type_name.split("/")
    whole = "/".join([package, folder, *rest] if len(rest) == 1 else [package, *rest])
    try:
        return find(whole)
    except CourseError as error:
        if folder == "msg":  # the error has ROS's words already
            raise
        word, end = {"srv": ("service", "_Request"), "action": ("action", "_Goal")}[folder]
        there = [
            name.removesuffix(end) for name in type_names() if f"/{folder}/" in name and name.endswith(end)
        ]
        if whole in there:
            raise
        message = f"The passed {word} type is invalid: {whole}{did_you_mean(whole, there)}"
        raise CourseError(message) from error


def check_type(name: str, type_name: str, there: Mapping[str, Sequence[str]]) -> None:
    """Raise a CourseError if a name exists with another type: waiting for it would never end."""
    if name in there and type_name not in there[name]:
        raise CourseError(f"{name} has the type {', '.join(there[name])}, not {type_name}.")


def fill(message: RosMessage, text: str) -> list[SetTime]:
    """Set a message's fields from YAML like ``{header: auto, x: 1.0}``.

    Returns:
        What sets the times that were given as ``now``, or with a header as ``auto``.

    Raises:
        CourseError: No YAML, no dictionary, or a value that does not fit; with ROS's words.
    """
    import yaml  # type: ignore[import-untyped]  # PyYAML ships no types

    try:
        values = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise CourseError(f"{text!r} is not YAML: {error}. Write it like '{{x: 1.0, y: 2.0}}'.") from error
    if not isinstance(values, dict):
        raise CourseError(
            "The passed value needs to be a dictionary in YAML format, like '{x: 1.0}' or 'x: 1.0' "
            "with a space after the colon."
        )
    try:
        return set_fields(message, values)
    except (AttributeError, AssertionError, TypeError, ValueError, OverflowError) as error:
        fields = ", ".join(f"{name}: {of}" for name, of in message.get_fields_and_field_types().items())
        raise CourseError(
            f"Failed to populate field: {error}. {type_name(message)} has {fields or 'no field'}."
        ) from error
