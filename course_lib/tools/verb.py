"""The verbs of the `ros2` command line, their options, and options that several commands share."""

import re
from argparse import ArgumentTypeError, Namespace
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.messages import RosMessage, type_name
from course_lib.ros.messages.conversions import SetTime, set_fields
from course_lib.ros.messages.definitions import type_names
from course_lib.tools.sources import Source

# Receives text with its line ends.
Write = Callable[[str], object]
Run = Callable[[Source, Namespace, Write], None]
# Types of topics, services or actions by name.
Types = Mapping[str, list[str]]
# Limit for times [s] and rates [Hz]. Larger values overflow a clock's nanoseconds.
MOST = 1e9
# Options of `course ros2` itself, which end where the words of ros2 begin.
COURSE_OPTIONS = frozenset({"--run", "--bag", "--seconds", "--robot"})
# Further options of `course ros2`, which a program may also have.
LINK_OPTIONS = frozenset({"--domain", "--send", "--call"})
# Called with a source, and True to include hidden names.
FindTypes = Callable[[Source, bool], Types]


@dataclass(frozen=True)
class Option:
    """An argument, described for argparse.

    Arguments with the same `exclusive` exclude each other.
    """

    flags: tuple[str, ...]
    settings: Mapping[str, Any]
    exclusive: str = ""


@dataclass(frozen=True)
class Verb:
    """`ros2 <command> <name>` with its arguments. The command of an executable is `run <package>`.

    Args:
        name: Empty for a command without verbs, like `ros2 doctor`.
        run: The function, which raises a CourseError with ROS's text for invalid arguments.
        is_immediate: Whether it subscribes immediately. Other verbs first wait for nodes to start.
        needs_nodes: Whether it needs nodes or a recording.
    """

    command: str
    name: str
    help: str
    options: tuple[Option, ...]
    run: Run
    is_immediate: bool = False
    needs_nodes: bool = True

    @property
    def words(self) -> list[str]:
        """The words after `ros2` that select this verb."""
        return f"{self.command} {self.name}".split()


def flag(*flags: str, help: str, exclusive: str = "", **settings: Any) -> Option:  # noqa: A002  # argparse's own word
    """Return an option without a value."""
    return Option(flags, {"action": "store_true", "help": help, **settings}, exclusive)


def value(*flags: str, help: str, exclusive: str = "", **settings: Any) -> Option:  # noqa: A002  # argparse's own word
    """Return an option with a value or, without a dash, a positional argument."""
    return Option(flags, {"help": help, **settings}, exclusive)


def positive(kind: type[int] | type[float]) -> Callable[[str], float]:
    """Return a type for argparse that accepts positive numbers, with ros2cli's error text."""

    def read(text: str) -> float:
        try:
            number = kind(text)
        except ValueError:
            number = kind(-1)
        if not number > 0:
            expected = "a positive integer" if kind is int else "positive"
            raise ArgumentTypeError(f"{'value' if kind is int else 'Value'} must be {expected}")
        if kind is float and not 1 / MOST <= number <= MOST:
            raise ArgumentTypeError(f"Value must be in {1 / MOST:g} … {MOST:g}")
        return number

    return read


def seconds(text: str) -> float:
    """Convert an argument to a time [s], which may be negative."""
    number = float(text)
    if not abs(number) <= MOST:
        raise ArgumentTypeError(f"{text!r} is not a time in seconds, {-MOST:g} … {MOST:g}")
    return number


def parse_unsigned(text: str) -> int:
    """Convert an argument to a non-negative integer, with ros2cli's error text."""
    number = int(text) if text.strip().isdecimal() else -1
    if number < 0:
        raise ArgumentTypeError("value must be non-negative integer")
    return number


def pattern(text: str) -> re.Pattern[str]:
    """Convert an argument to a regular expression."""
    try:
        return re.compile(text)
    except re.error as error:
        raise ArgumentTypeError(f"{text!r} is not a regular expression: {error}") from error


# Options of verbs that inspect the graph (ros2cli.node.strategy).
NODE_OPTIONS = (
    value("--spin-time", type=seconds, default=0.0, help="Spin time in seconds to wait for discovery"),
    flag("-s", "--use-sim-time", help="Enable ROS simulation time"),
    flag("--no-daemon", help="Do not spawn nor use an already running daemon; here there is none"),
)


def show_types(kind: str) -> Option:
    """Return the option that adds types to names."""
    return flag("-t", "--show-types", help=f"Additionally show the {kind} type")


def count(kind: str) -> Option:
    """Return the option that prints the number of names instead of the names."""
    help_text = f"Only display the number of {kind}s discovered"
    return flag("-c", f"--count-{kind}s", dest="count", help=help_text)


def hidden(kind: str) -> Option:
    """Return the option that includes hidden names."""
    return flag(f"--include-hidden-{kind}s", dest="hidden", help=f"Consider hidden {kind}s as well")


def write_names(types_by_name: Types, arguments: Namespace, write: Write) -> None:
    """Print names with types, or their number, depending on options `show_types` and `count`."""
    if arguments.count:
        write(f"{len(types_by_name)}\n")
        return
    for name, types in types_by_name.items():
        write(f"{name} [{', '.join(types)}]\n" if arguments.show_types else f"{name}\n")


def make_list_verb(kind: str, about: str, find: FindTypes, *options: Option) -> Verb:
    """Return a verb that prints names with types, or their number."""

    def run(source: Source, arguments: Namespace, write: Write) -> None:
        write_names(find(source, getattr(arguments, "hidden", True)), arguments, write)

    return Verb(kind, "list", about, (*NODE_OPTIONS, show_types(kind), count(kind), *options), run)


def make_type_verb(kind: str, about: str, find: FindTypes, name: Option) -> Verb:
    """Return a verb that prints the types of a name."""

    def run(source: Source, arguments: Namespace, write: Write) -> None:
        name, types_by_name = getattr(arguments, f"{kind}_name"), find(source, True)
        if name not in types_by_name:
            raise CourseError(f"Unknown {kind} '{name}'{did_you_mean(name, types_by_name)}")
        write("".join(f"{type_name}\n" for type_name in types_by_name[name]))

    return Verb(kind, "type", about, (*NODE_OPTIONS, name), run)


def make_find_verb(kind: str, find: FindTypes, type_help: str) -> Verb:
    """Return a verb that prints the names with a given type."""

    def run(source: Source, arguments: Namespace, write: Write) -> None:
        type_name = getattr(arguments, f"{kind}_type")
        names = [name for name, types in find(source, arguments.hidden).items() if type_name in types]
        write(f"{len(names)}\n" if arguments.count else "".join(f"{name}\n" for name in names))

    options = (*NODE_OPTIONS, value(f"{kind}_type", help=type_help), count(kind), hidden(kind))
    return Verb(kind, "find", f"Output a list of available {kind}s of a given type", options, run)


def kind_of(find: Any, type_name: str, folder: str) -> Any:
    """Return the class of a message, service or action type.

    As in ROS, its folder may be omitted.
    """
    package, *name_parts = type_name.split("/")
    full_name = "/".join([package, folder, *name_parts] if len(name_parts) == 1 else [package, *name_parts])
    try:
        # Services and actions are found by the names of their parts, which need a package.
        if not name_parts and folder != "msg":
            raise CourseError(f"{type_name} has no package. Write PACKAGE/{folder}/{type_name}.")
        return find(full_name)
    except CourseError as error:
        if folder == "msg":
            raise CourseError(f"The passed message type is invalid: {error}") from error
        noun, suffix = {"srv": ("service", "_Request"), "action": ("action", "_Goal")}[folder]
        candidates = [
            name.removesuffix(suffix)
            for name in type_names()
            if f"/{folder}/" in name and name.endswith(suffix)
        ]
        if full_name in candidates:
            raise
        same_name = [name for name in candidates if name.rpartition("/")[2] == type_name.rpartition("/")[2]]
        suggestion = did_you_mean(full_name, same_name or candidates)
        if same_name and not name_parts:
            suggestion = f". Did you mean {' or '.join(same_name[:3])}?"
        message = f"The passed {noun} type is invalid: {full_name}{suggestion}"
        raise CourseError(message) from error


def check_type(name: str, type_name: str, types_by_name: Mapping[str, Sequence[str]]) -> None:
    """Raise a CourseError if a name exists with a different type, because waiting for it would never end."""
    if name in types_by_name and type_name not in types_by_name[name]:
        raise CourseError(f"{name} has the type {', '.join(types_by_name[name])}, not {type_name}.")


def fill(message: RosMessage, text: str, failed: str = "Failed to populate field") -> list[SetTime]:
    """Set a message's fields from YAML like ``{header: auto, x: 1.0}``.

    Returns:
        Functions that set the times given as ``now``, or as ``auto`` for a header.

    Raises:
        CourseError: The text is not YAML or not a dictionary, or a value is invalid. The message is
            ROS's.
    """
    import yaml

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
        raise CourseError(f"{failed}: {error}. {type_name(message)} has {fields or 'no field'}.") from error
