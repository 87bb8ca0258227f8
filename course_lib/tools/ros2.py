"""The `ros2` command line: its verbs and the executables of the kit."""

import sys
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections import defaultdict
from collections.abc import Sequence
from functools import partial
from itertools import zip_longest
from typing import TYPE_CHECKING, Any, NoReturn

from course_lib.errors import CourseError, did_you_mean
from course_lib.ros.graph.graph import current_graph
from course_lib.ros.robot.connect import connect, disconnect
from course_lib.tools.bag import BAG_INFO, BAG_PLAY, BAG_RECORD
from course_lib.tools.doctor import DOCTOR_VERBS
from course_lib.tools.entities import (
    ACTION_VERBS,
    INTERFACE_VERBS,
    LIFECYCLE_VERBS,
    NODE_VERBS,
    SERVICE_VERBS,
)
from course_lib.tools.executables import NODE_EXECUTABLES, program_arguments, run_with_rclpy, spin
from course_lib.tools.launch import launch_verbs
from course_lib.tools.param import PARAM_VERBS
from course_lib.tools.pkg import pkg_verbs
from course_lib.tools.sources import DISCOVERY, GraphSource, Source
from course_lib.tools.tf2 import STATIC_TRANSFORM_PUBLISHER, TF2_ECHO, TF2_MONITOR, VIEW_FRAMES
from course_lib.tools.topic import TOPIC_ECHO, TOPIC_LISTS, TOPIC_MEASURES, TOPIC_PUB
from course_lib.tools.verb import COURSE_OPTIONS, LINK_OPTIONS, Verb, Write, value

if TYPE_CHECKING:
    from course_lib.ros.programs.package_programs import Executables


def _connect(source: Source, arguments: Namespace, write: Write) -> None:
    connect(arguments.router, domain=arguments.domain, send=arguments.send, call=arguments.call)


_OPTIONS = (
    value("router", help="The robot over DDS, dds/192.168.1.5, or its Zenoh router, tcp/192.168.1.5:7447"),
    value("--domain", type=int, help="The robot's ROS_DOMAIN_ID"),
    value("--send", action="append", default=[], help="A topic that may be published to the robot"),
    value("--call", action="append", default=[], help="A service or action that may be called"),
)
LINK_VERBS = (
    Verb(
        "connect",
        "",
        "Link this notebook to a robot",
        _OPTIONS,
        _connect,
        is_immediate=True,
        needs_nodes=False,
    ),
    Verb(
        "disconnect",
        "",
        "End the link to the robot",
        (),
        lambda *_: disconnect(),
        is_immediate=True,
        needs_nodes=False,
    ),
)

_TOOLS = (("tf2_ros", "tf2_echo"), ("tf2_ros", "tf2_monitor"), ("tf2_tools", "view_frames"))


def _ros2_executable(*words: str) -> None:
    """Run `ros2 <words>` with the arguments of the running program."""
    source = GraphSource(current_graph(), discovery=DISCOVERY)
    ros2([*words, *program_arguments()], source, sys.stdout.write)


def _static_transform_publisher() -> None:
    words = program_arguments()
    if words and words[0].startswith("--"):
        pairs = zip_longest(words[::2], words[1::2], fillvalue="")
        # Joined with "=", because argparse would take a separate -1e-3 for an option.
        words = [f"{name}={setting}" for name, setting in pairs]
    command = ["run", "tf2_ros", "static_transform_publisher", *words]
    ros2(command, GraphSource(current_graph()), sys.stdout.write)
    spin()


EXECUTABLES: "Executables" = {
    **NODE_EXECUTABLES,
    ("ros2cli", "ros2"): partial(run_with_rclpy, _ros2_executable),
    ("tf2_ros", "static_transform_publisher"): partial(run_with_rclpy, _static_transform_publisher),
    **{words: partial(run_with_rclpy, partial(_ros2_executable, "run", *words)) for words in _TOOLS},
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
    # These verbs need the executables, some of which call verbs themselves.
    *launch_verbs(EXECUTABLES),
)
# The descriptions are from ros2cli.
COMMANDS = {
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
# Commands of ros2cli that the kit does not have, with the reasons.
_NOT_OFFERED = {
    "component": "Here components start as nodes: `ros2 node list` lists them, and a launch file starts them",
    "control": "It belongs to ros2_control, which is made of compiled plugins",
    "daemon": "No daemon is needed here",
    "multicast": "No network is used here. `ros2 doctor` shows the link to a robot",
    "security": "Messages are not encrypted here",
    "test": "Tests of nodes and launch files run with pytest",
    "trace": "Callbacks are not traced here",
}
HELP = {"-h", "--help"}
_BUFFERING = (
    "Do not force line buffering in stdout and instead use the python default buffering, which "
    "might be affected by PYTHONUNBUFFERED/-u and depends on whatever stdout is interactive or not"
)


def ros2(words: Sequence[str], source: Source, write: Write) -> None:
    """Run `ros2 <words>`. `write` receives the output.

    Raises:
        CourseError: The command or an argument is unknown, or the command itself reports an error.
    """
    verb = find_verb(words)
    if verb is None:
        _explain(list(words), write)
        return
    parser = _Parser(prog=f"ros2 {' '.join(verb.words)}", description=verb.help)
    groups: dict[str, Any] = defaultdict(parser.add_mutually_exclusive_group)
    for option in verb.options:
        target = groups[option.exclusive] if option.exclusive else parser
        target.add_argument(*option.flags, **option.settings)
    verb_arguments = words[len(verb.words) :]
    if HELP & set(verb_arguments):
        write(parser.format_help())
        return
    arguments = parser.parse_args(verb_arguments)
    if pause := getattr(arguments, "spin_time", 0.0) or (0.0 if verb.is_immediate else source.discovery):
        source.wait(lambda: False, pause)
    try:
        verb.run(source, arguments, write)
    except CourseError as error:
        # As in ros2cli, a command that fails has the exit code 1, and a wrong command line 2.
        error.exit_code = 1
        raise


def find_verb(words: Sequence[str]) -> Verb | None:
    """Return the verb at the beginning of a command line."""
    return next((verb for verb in VERBS if verb.words == list(words[: len(verb.words)])), None)


class _Parser(ArgumentParser):
    """An argument parser that raises an error instead of exiting."""

    def error(self, message: str) -> NoReturn:
        """Print the usage, and raise an error with the message and the closest option."""
        self.print_usage(sys.stderr)
        if message.startswith("unrecognized arguments: -"):
            option = message.split()[2]
            if option.partition("=")[0] in COURSE_OPTIONS | LINK_OPTIONS:
                value = "" if "=" in option else " …"
                message += f". Options of course come first: course ros2 {option}{value} "
                message += f"{self.prog.removeprefix('ros2 ')} …"
            else:
                message += did_you_mean(option, self._option_string_actions)
        raise CourseError(f"{self.prog}: error: {message}")


def _explain(words: list[str], write: Write) -> None:
    """Print the possible continuations of a command. Raise a CourseError for an unknown command."""
    known_count = 0
    while any(
        verb.words[: known_count + 1] == words[: known_count + 1] for verb in VERBS
    ) and known_count < len(words):
        known_count += 1
    path, remaining_words = words[:known_count], words[known_count:]
    names = {verb.words[known_count]: verb.help for verb in VERBS if verb.words[:known_count] == path}
    if not known_count:
        names = {name: COMMANDS[name] for name in names}
    prog = " ".join(["ros2", *path])
    about = COMMANDS[path[0]] if path else "ros2 is an extensible command-line tool for ROS 2."
    parser = _Parser(prog=prog, description=about, formatter_class=RawDescriptionHelpFormatter)
    if not path:
        parser.add_argument("--use-python-default-buffering", action="store_true", help=_BUFFERING)
    width = max(map(len, names))
    parser.add_subparsers(
        title="Commands",
        description="".join(f"{name.ljust(width)}  {names[name]}\n" for name in sorted(names)),
        metavar=f"Call `{prog} <command> -h` for more detailed usage.",
    )
    if not remaining_words or HELP & set(remaining_words):
        write(parser.format_help())
    elif remaining_words[0].startswith("-"):
        parser.error(f"unrecognized arguments: {remaining_words[0]}")
    else:
        metavar = f"argument Call `{prog} <command> -h` for more detailed usage."
        choices = ", ".join(map(repr, sorted(names)))
        reason = "" if path else _NOT_OFFERED.get(remaining_words[0], "")
        hint = f". {reason}" if reason else did_you_mean(remaining_words[0], names)
        parser.error(f"{metavar}: invalid choice: {remaining_words[0]!r} (choose from {choices}){hint}")
