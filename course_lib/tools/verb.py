"""One verb of the `ros2` command line, as a row of the table in ros2.py."""

from argparse import Namespace
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from course_lib.tools.sources import Source

Write = Callable[[str], object]  # takes text, line ends included


@dataclass(frozen=True)
class Option:
    """One argument, in argparse's words."""

    flags: tuple[str, ...]
    settings: Mapping[str, Any]


def flag(*flags: str, help: str) -> Option:  # noqa: A002  # argparse's own word
    """Give an option that is on or off."""
    return Option(flags, {"action": "store_true", "help": help})


def value(*flags: str, help: str, **settings: Any) -> Option:  # noqa: A002  # argparse's own word
    """Give an option with a value, or, without a dash, a positional argument."""
    return Option(flags, {"help": help, **settings})


@dataclass(frozen=True)
class Verb:
    """What `ros2 <command> <name>` does, with its arguments; an executable's command is `run <package>`."""

    command: str
    name: str
    help: str
    options: tuple[Option, ...]
    run: Callable[[Source, Namespace, Write], None]

    @property
    def words(self) -> list[str]:
        """What a command line that means it begins with."""
        return [*self.command.split(), self.name]
