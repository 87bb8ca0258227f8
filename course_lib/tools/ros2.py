"""The `ros2` command line: a table of its verbs, over a run's nodes or a recording."""

from argparse import ArgumentParser
from collections.abc import Sequence
from typing import NoReturn

from course_lib.errors import CourseError
from course_lib.tools.sources import Source
from course_lib.tools.topic_echo import TOPIC_ECHO
from course_lib.tools.topic_list import TOPIC_LIST
from course_lib.tools.verb import Verb, Write

VERBS = (TOPIC_ECHO, TOPIC_LIST)


def ros2(words: Sequence[str], source: Source, write: Write) -> None:
    """Do what `ros2 <words>` does.

    Args:
        words: The command line after `ros2`.
        source: Where to look.
        write: Takes what ROS prints.

    Raises:
        CourseError: No such command or argument, or what the command itself finds wrong.
    """
    verb = next((verb for verb in VERBS if [verb.command, verb.name] == list(words[:2])), None)
    if verb is None:
        _explain(words, write)
    elif {"-h", "--help"} & set(words):
        write(_parser(verb).format_help())
    else:
        verb.run(source, _parser(verb).parse_args(list(words[2:])), write)


class _Parser(ArgumentParser):
    """An argument parser that leaves the process alone."""

    def error(self, message: str) -> NoReturn:
        """Say in one line what is wrong and what shows how it would be right."""
        raise CourseError(f"{self.prog}: {message}. `{self.prog} --help` shows how it is written.")


def _parser(verb: Verb) -> ArgumentParser:
    parser = _Parser(prog=f"ros2 {verb.command} {verb.name}", description=verb.help, add_help=False)
    for option in verb.options:
        parser.add_argument(*option.flags, **option.settings)
    return parser


def _explain(words: Sequence[str], write: Write) -> None:
    """List the verbs; a command that is not among them is an error."""
    commands = {verb.command for verb in VERBS}
    asked = [word for word in words if word not in ("-h", "--help")]
    if len(asked) > 1 or not set(asked) <= commands:
        there = ", ".join(f"ros2 {verb.command} {verb.name}" for verb in VERBS)
        raise CourseError(f"There is no `ros2 {' '.join(asked[:2])}` here. There are: {there}.")
    for verb in VERBS:
        write(f"ros2 {verb.command} {verb.name}  {verb.help}\n")
