"""The `ros2` command line: the tables of its verbs and of the kit's executables."""

import sys
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from collections import defaultdict
from collections.abc import Sequence
from functools import partial
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, NoReturn

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.graph import current_graph
from course_lib.tools.action import ACTION_VERBS
from course_lib.tools.bag import BAG_INFO, BAG_RECORD
from course_lib.tools.bag_play import BAG_PLAY
from course_lib.tools.doctor import DOCTOR_VERBS
from course_lib.tools.executables import NODE_EXECUTABLES, own_words, spin, with_rclpy
from course_lib.tools.interface import INTERFACE_VERBS
from course_lib.tools.launch import launch_verbs
from course_lib.tools.lifecycle import LIFECYCLE_VERBS
from course_lib.tools.node import NODE_VERBS
from course_lib.tools.param import PARAM_VERBS
from course_lib.tools.pkg import pkg_verbs
from course_lib.tools.robot_link import LINK_VERBS
from course_lib.tools.service import SERVICE_VERBS
from course_lib.tools.sources import DISCOVERY, GraphSource, Source
from course_lib.tools.static_transform import STATIC_TRANSFORM_PUBLISHER
from course_lib.tools.tf2 import TF2_ECHO, TF2_MONITOR
from course_lib.tools.topic.list import TOPIC_LISTS
from course_lib.tools.topic.pub import TOPIC_PUB
from course_lib.tools.topic.subscribe import TOPIC_ECHO, TOPIC_MEASURES
from course_lib.tools.verb import Verb, Write
from course_lib.tools.view_frames import VIEW_FRAMES

if TYPE_CHECKING:
    from course_lib.ros.package_programs import Executables

_TOOLS = (("tf2_ros", "tf2_echo"), ("tf2_ros", "tf2_monitor"), ("tf2_tools", "view_frames"))


def _ros2_executable(*words: str) -> None:
    """Run `ros2 <words>` with the arguments of the running program."""
    source = GraphSource(current_graph(), discovery=DISCOVERY)
    ros2([*words, *own_words()], source, sys.stdout.write)


def _static_transform_publisher() -> None:
    words = own_words()
    if words and words[0].startswith("--"):
        pairs = zip_longest(words[::2], words[1::2], fillvalue="")
        words = [f"{name}={setting}" for name, setting in pairs]  # argparse takes a lone -1e-3 for an option
    command = ["run", "tf2_ros", "static_transform_publisher", *words]
    ros2(command, GraphSource(current_graph()), sys.stdout.write)
    spin()


EXECUTABLES: "Executables" = {
    **NODE_EXECUTABLES,
    ("ros2cli", "ros2"): partial(with_rclpy, _ros2_executable),
    ("tf2_ros", "static_transform_publisher"): partial(with_rclpy, _static_transform_publisher),
    **{words: partial(with_rclpy, partial(_ros2_executable, "run", *words)) for words in _TOOLS},
}
VERBS = (
    TOPIC_ECHO,
    *TOPIC_LISTS,
    *TOPIC_MEASURES,
    TOPIC_PUB,
    TF2_ECHO,
    TF2_MONITOR,
    STATIC_TRANSFORM_PUBLISHER,
    VIEW_FRAMES,
    BAG_INFO,
    BAG_PLAY,
    BAG_RECORD,
    *PARAM_VERBS,
    *SERVICE_VERBS,
    *ACTION_VERBS,
    *NODE_VERBS,
    *LIFECYCLE_VERBS,
    *INTERFACE_VERBS,
    *DOCTOR_VERBS,
    *LINK_VERBS,
    *pkg_verbs(EXECUTABLES),
    *launch_verbs(EXECUTABLES),  # after the executables that are verbs
)
COMMANDS = {  # what ros2cli says of them
    "action": "Various action related sub-commands",
    "connect": "Link this notebook to a robot",
    "disconnect": "End the link to the robot",
    "bag": "Various rosbag related sub-commands",
    "doctor": "Check ROS setup and other potential issues",
    "launch": "Run a launch file",
    "interface": "Show information about ROS interfaces",
    "lifecycle": "Various lifecycle related sub-commands",
    "node": "Various node related sub-commands",
    "param": "Various param related sub-commands",
    "pkg": "Various package related sub-commands",
    "run": "Run a package specific executable",
    "service": "Various service related sub-commands",
    "topic": "Various topic related sub-commands",
    "wtf": "Use `wtf` as alias to `doctor`",
}
HELP = {"-h", "--help"}
_BUFFERING = (
    "Do not force line buffering in stdout and instead use the python default buffering, which might be "
    "affected by PYTHONUNBUFFERED/-u and depends on whatever stdout is interactive or not"
)


def ros2(words: Sequence[str], source: Source, write: Write) -> None:
    """Run `ros2 <words>`; `write` receives the output.

    Raises:
        CourseError: No such command or argument, or what the command itself finds wrong.
    """
    verb = find_verb(words)
    if verb is None:
        _explain(list(words), write)
        return
    parser, rest = _parser(verb, write), words[len(verb.words) :]
    if HELP & set(rest):
        write(parser.format_help())
        return
    arguments = parser.parse_args(rest)
    if pause := getattr(arguments, "spin_time", 0.0) or (0.0 if verb.from_start else source.discovery):
        source.wait(lambda: False, pause)
    verb.run(source, arguments, write)


def find_verb(words: Sequence[str]) -> Verb | None:
    """Return the verb that a command line begins with."""
    return next((verb for verb in VERBS if verb.words == list(words[: len(verb.words)])), None)


class _Parser(ArgumentParser):
    """An argument parser that raises instead of exiting."""

    write: Write

    def error(self, message: str) -> NoReturn:
        """Print the usage, and raise the message with the nearest option."""
        self.write(self.format_usage())
        if message.startswith("unrecognized arguments: -"):
            message += did_you_mean(message.split()[2], self._option_string_actions)
        raise CourseError(f"{self.prog}: error: {message}")


def _parser(verb: Verb, write: Write) -> ArgumentParser:
    parser = _Parser(prog=f"ros2 {' '.join(verb.words)}", description=verb.help)
    parser.write = write
    groups: dict[str, Any] = defaultdict(parser.add_mutually_exclusive_group)
    for option in verb.options:
        target = groups[option.exclusive] if option.exclusive else parser
        target.add_argument(*option.flags, **option.settings)
    return parser


def _explain(words: list[str], write: Write) -> None:
    """Print the words that can follow an incomplete command; raises a CourseError for a wrong one."""
    known = 0
    while any(verb.words[: known + 1] == words[: known + 1] for verb in VERBS) and known < len(words):
        known += 1
    path, rest = words[:known], words[known:]
    names = {verb.words[known]: verb.help for verb in VERBS if verb.words[:known] == path}
    if not known:
        names = {name: COMMANDS[name] for name in names}
    prog = " ".join(["ros2", *path])
    about = COMMANDS[path[0]] if path else "ros2 is an extensible command-line tool for ROS 2."
    parser = _Parser(prog=prog, description=about, formatter_class=RawDescriptionHelpFormatter)
    parser.write = write
    if not path:
        parser.add_argument("--use-python-default-buffering", action="store_true", help=_BUFFERING)
    width = max(map(len, names))
    parser.add_subparsers(
        title="Commands",
        description="".join(f"{name.ljust(width)}  {names[name]}\n" for name in sorted(names)),
        metavar=f"Call `{prog} <command> -h` for more detailed usage.",
    )
    if not rest or HELP & set(rest):
        write(parser.format_help())
    elif rest[0].startswith("-"):
        parser.error(f"unrecognized arguments: {rest[0]}")
    else:
        metavar = f"argument Call `{prog} <command> -h` for more detailed usage."
        choices = ", ".join(map(repr, sorted(names)))
        hint = did_you_mean(rest[0], names)
        parser.error(f"{metavar}: invalid choice: {rest[0]!r} (choose from {choices}){hint}")
