"""The `ros2` command line: a table of its verbs, over a run's nodes or a recording."""

import sys
from argparse import ArgumentParser
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from course_lib.errors import CourseError
from course_lib.recording import Recording, read_bag
from course_lib.tools.param import PARAM_GET, PARAM_LIST, PARAM_SET
from course_lib.tools.run import recorded
from course_lib.tools.sources import RecordingSource, Source
from course_lib.tools.tf2.echo import TF2_ECHO
from course_lib.tools.tf2.monitor import TF2_MONITOR
from course_lib.tools.tf2.static_transform_publisher import STATIC_TRANSFORM_PUBLISHER
from course_lib.tools.tf2.view_frames import VIEW_FRAMES
from course_lib.tools.topic.echo import TOPIC_ECHO
from course_lib.tools.topic.list import TOPIC_LIST
from course_lib.tools.verb import Verb, Write

VERBS = (
    TOPIC_ECHO,
    TOPIC_LIST,
    TF2_ECHO,
    TF2_MONITOR,
    STATIC_TRANSFORM_PUBLISHER,
    VIEW_FRAMES,
    PARAM_LIST,
    PARAM_GET,
    PARAM_SET,
)


def ros2(words: Sequence[str], source: Source, write: Write) -> None:
    """Do what `ros2 <words>` does.

    Args:
        words: The command line after `ros2`.
        source: Where to look.
        write: Takes what ROS prints.

    Raises:
        CourseError: No such command or argument, or what the command itself finds wrong.
    """
    verb = next((verb for verb in VERBS if verb.words == list(words[: len(verb.words)])), None)
    if verb is None:
        _explain(words, write)
    elif {"-h", "--help"} & set(words):
        write(_parser(verb).format_help())
    else:
        verb.run(source, _parser(verb).parse_args(list(words[len(verb.words) :])), write)


def ros2_over(words: Sequence[str], *, files: Sequence[Path], bag: Path | None, seconds: float) -> int:
    """Do what `ros2 <words>` does, over what programs publish in a run, or over a recording.

    Returns:
        The exit code of the programs.

    Raises:
        CourseError: Nowhere to look, or in two places; otherwise as `ros2`.
    """
    asks_for_help = not words or bool({"-h", "--help"} & set(words))
    if bool(files) + (bag is not None) != 1 and not asks_for_help:
        ways = (f"course ros2 {where} {words[0]} …" for where in ("--run program.py", "--bag folder"))
        raise CourseError(f"Say where to look: {', or '.join(ways)}")
    recording, code = Recording(()), 0
    if bag is not None:
        recording = read_bag(bag)
    elif files:
        recording, code = recorded(files, seconds=seconds)
    ros2(words, RecordingSource(recording), sys.stdout.write)
    return code


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
    asked = [word for word in words if word not in ("-h", "--help")]
    if all(verb.words[: len(asked)] != asked for verb in VERBS):
        there = ", ".join(f"ros2 {verb.command} {verb.name}" for verb in VERBS)
        raise CourseError(f"There is no `ros2 {' '.join(asked[:3])}` here. There are: {there}.")
    for verb in VERBS:
        write(f"ros2 {verb.command} {verb.name}  {verb.help}\n")
