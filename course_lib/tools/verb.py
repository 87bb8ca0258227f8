"""One verb of the `ros2` command line, as a row of the table in ros2.py."""

from argparse import ArgumentTypeError, Namespace
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from course_lib.tools.sources import Source

Write = Callable[[str], object]  # takes text, line ends included
Run = Callable[[Source, Namespace, Write], None]


@dataclass(frozen=True)
class Option:
    """One argument, in argparse's words."""

    flags: tuple[str, ...]
    settings: Mapping[str, Any]


def flag(*flags: str, help: str, **settings: Any) -> Option:  # noqa: A002  # argparse's own word
    """Give an option that is on or off."""
    return Option(flags, {"action": "store_true", "help": help, **settings})


def value(*flags: str, help: str, **settings: Any) -> Option:  # noqa: A002  # argparse's own word
    """Give an option with a value, or, without a dash, a positional argument."""
    return Option(flags, {"help": help, **settings})


NODE_OPTIONS = (  # of verbs that look at the graph (ros2cli.node.strategy)
    value("--spin-time", type=float, default=0.0, help="Spin time in seconds to wait for discovery"),
    flag("-s", "--use-sim-time", help="Enable ROS simulation time; here it is robot time, always"),
    flag("--no-daemon", help="Do not spawn nor use an already running daemon; here there is none"),
)


@dataclass(frozen=True)
class Verb:
    """What `ros2 <command> <name>` does, with its arguments; an executable's command is `run <package>`.

    A command without verbs, like `ros2 doctor`, has no name. Verbs that listen hear a run `from_start` on;
    others first give its nodes a moment to come up. What `looks` at neither nodes nor a recording runs alone.
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
        """What a command line that means it begins with."""
        return f"{self.command} {self.name}".split()


def positive(kind: type[int] | type[float]) -> Callable[[str], float]:
    """Give what reads a positive number, for argparse, with ros2cli's complaint."""

    def read(text: str) -> float:
        try:
            number = kind(text)
        except ValueError:
            number = kind(-1)
        if not number > 0:
            what = "a positive integer" if kind is int else "positive"
            raise ArgumentTypeError(f"{'value' if kind is int else 'Value'} must be {what}")
        return number

    return read
