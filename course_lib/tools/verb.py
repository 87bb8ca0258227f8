"""Verbs of the `ros2` command line, their options, and those that several commands share."""

import re
from argparse import ArgumentTypeError, Namespace
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from course_lib.tools.sources import Source

Write = Callable[[str], object]  # takes text, line ends included
Run = Callable[[Source, Namespace, Write], None]
Types = Mapping[str, list[str]]  # of topics, services or actions, by name
MOST = 1e9  # [s] or [Hz]: what is beyond does not fit a clock's nanoseconds
FindTypes = Callable[[Source, bool], Types]  # the flag adds hidden names


@dataclass(frozen=True)
class Option:
    """One argument, in argparse's words; of those with the same `exclusive` only one may be given."""

    flags: tuple[str, ...]
    settings: Mapping[str, Any]
    exclusive: str = ""


@dataclass(frozen=True)
class Verb:
    """`ros2 <command> <name>` with its arguments; the command of an executable is `run <package>`.

    Args:
        name: Empty for a command without verbs, like `ros2 doctor`.
        run: Raises a CourseError with ROS's words for wrong arguments.
        from_start: Whether it listens from its first moment; others first wait for nodes that come up.
        looks: Whether it needs nodes or a recording.
    """

    command: str
    name: str
    help: str
    options: tuple[Option, ...]
    run: Run
    from_start: bool = False
    looks: bool = True

    @property
    def words(self) -> list[str]:
        """The words behind `ros2` that select this verb."""
        return f"{self.command} {self.name}".split()


def flag(*flags: str, help: str, exclusive: str = "", **settings: Any) -> Option:  # noqa: A002  # argparse's own word
    """Return an option that is on or off."""
    return Option(flags, {"action": "store_true", "help": help, **settings}, exclusive)


def value(*flags: str, help: str, exclusive: str = "", **settings: Any) -> Option:  # noqa: A002  # argparse's own word
    """Return an option with a value, or, without a dash, a positional argument."""
    return Option(flags, {"help": help, **settings}, exclusive)


def positive(kind: type[int] | type[float]) -> Callable[[str], float]:
    """Return an argparse type for positive numbers, with ros2cli's complaint."""

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
    """Read a time, of either sign: an argparse type."""
    number = float(text)
    if not abs(number) <= MOST:
        raise ArgumentTypeError(f"{text!r} is not a time in seconds, {-MOST:g} … {MOST:g}")
    return number


def unsigned(text: str) -> int:
    """Read an integer from 0 on, with ros2cli's complaint."""
    number = int(text) if text.strip().isdecimal() else -1
    if number < 0:
        raise ArgumentTypeError("value must be non-negative integer")
    return number


def pattern(text: str) -> re.Pattern[str]:
    """Read a regular expression."""
    try:
        return re.compile(text)
    except re.error as error:
        raise ArgumentTypeError(f"{text!r} is not a regular expression: {error}") from error


NODE_OPTIONS = (  # of verbs that look at the graph (ros2cli.node.strategy)
    value("--spin-time", type=seconds, default=0.0, help="Spin time in seconds to wait for discovery"),
    flag("-s", "--use-sim-time", help="Enable ROS simulation time"),
    flag("--no-daemon", help="Do not spawn nor use an already running daemon; here there is none"),
)


def show_types(kind: str) -> Option:
    """Return the option that adds types to names."""
    return flag("-t", "--show-types", help=f"Additionally show the {kind} type")


def count(kind: str) -> Option:
    """Return the option that prints the number of names in place of the names."""
    help_text = f"Only display the number of {kind}s discovered"
    return flag("-c", f"--count-{kind}s", dest="count", help=help_text)


def hidden(kind: str) -> Option:
    """Return the option that includes hidden names."""
    return flag(f"--include-hidden-{kind}s", dest="hidden", help=f"Consider hidden {kind}s as well")


def write_names(found: Types, arguments: Namespace, write: Write) -> None:
    """Print names, or their number, as the options `show_types` and `count` ask for."""
    if arguments.count:
        write(f"{len(found)}\n")
        return
    for name, types in found.items():
        write(f"{name} [{', '.join(types)}]\n" if arguments.show_types else f"{name}\n")


def type_verb(kind: str, about: str, find: FindTypes, name: Option) -> Verb:
    """Return the verb that prints the types of a name; as in ROS nothing for an unknown name."""

    def run(source: Source, arguments: Namespace, write: Write) -> None:
        types = find(source, True).get(getattr(arguments, f"{kind}_name"), ())
        write("".join(f"{one}\n" for one in types))

    return Verb(kind, "type", about, (*NODE_OPTIONS, name), run)


def find_verb(kind: str, find: FindTypes, type_help: str) -> Verb:
    """Return the verb that prints the names of a type."""

    def run(source: Source, arguments: Namespace, write: Write) -> None:
        wanted = getattr(arguments, f"{kind}_type")
        found = [name for name, types in find(source, arguments.hidden).items() if wanted in types]
        write(f"{len(found)}\n" if arguments.count else "".join(f"{name}\n" for name in found))

    options = (*NODE_OPTIONS, value(f"{kind}_type", help=type_help), count(kind), hidden(kind))
    return Verb(kind, "find", f"Output a list of available {kind}s of a given type", options, run)
