"""Arguments that the verbs of `ros2 bag` have in common."""

import re
from argparse import ArgumentTypeError
from pathlib import Path

from course_lib.tools.verb import Option, value


def existing(text: str) -> Path:
    """Read a bag's path, with ros2bag's complaint."""
    if not Path(text).exists():
        raise ArgumentTypeError(f"Bag path '{text}' does not exist!")
    return Path(text)


def pattern(text: str) -> re.Pattern[str]:
    """Read a regular expression."""
    try:
        return re.compile(text)
    except re.error as error:
        raise ArgumentTypeError(f"{text!r} is no regular expression: {error}") from error


def several(*flags: str, help: str, metavar: str = "Topic") -> Option:  # noqa: A002  # argparse's own word
    """Give an option that takes a list."""
    return value(*flags, help=help, metavar=metavar, nargs="+", default=[])


READER = (
    value("bag_path", type=existing, help="Bag to open"),
    value("-s", "--storage", choices=("mcap", "sqlite3"), help="Storage of the bag; it is found out anyway"),
)
