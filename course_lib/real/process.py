"""Programs under the real rclpy in separate processes, and the graph linked to them over DDS.

`course run my_node.py --ros` runs the same file on the real ROS 2; the kit displays and records it.
"""

import os
import random
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO

from course_lib.errors import CourseError
from course_lib.real.environment import RealEnvironment, clean_variables, find_environment
from course_lib.real.types import missing_packages
from course_lib.ros.dds.link import DdsLink
from course_lib.ros.graph.graph import Sample, use_graph
from course_lib.ros.graph.topics import OWN_TOPICS
from course_lib.ros.messages.definitions import type_hash
from course_lib.ros.notices import print_to_stderr
from course_lib.ros.programs import import_path
from course_lib.ros.robot.robot_graph import RobotGraph
from course_lib.ros.robot.sending import Permissions
from course_lib.ros.time import virtual_time, wall
from course_lib.ros.time.interrupts import SIGNALED, exit_at_signals
from course_lib.ros.time.time_lock import time_lock

HOST = "127.0.0.1"
KIT = Path(__file__).parents[2]
PROGRAM = Path(__file__).parent / "child" / "program.py"
# Linux does not use the ports of these domains for outgoing connections.
DOMAINS = range(1, 101)
# Port of the first participant in domain 0.
PORT, PORTS_OF_A_DOMAIN = 7410, 250
# Number of attempts to find a free domain.
TRIES = 20
WARM_TYPES = ("visualization_msgs/msg/MarkerArray", "tf2_msgs/msg/TFMessage", "rcl_interfaces/msg/Log")
# Signals that end a program, and the time to wait after each [s].
SIGNALS = ((signal.SIGINT, 5.0), (signal.SIGTERM, 2.0), (signal.SIGKILL, 5.0))
# Only the loopback device is used, so that nothing leaves this computer even if a remote computer
# requests discovery.
PROFILES = """<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns="http://www.eprosima.com"><profiles>
  <transport_descriptors><transport_descriptor>
    <transport_id>loopback</transport_id><type>UDPv4</type>
    <interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList>
  </transport_descriptor></transport_descriptors>
  <participant profile_name="loopback" is_default_profile="true"><rtps>
    <userTransports><transport_id>loopback</transport_id></userTransports>
    <useBuiltinTransports>false</useBuiltinTransports>
  </rtps></participant>
</profiles></dds>
"""


class RealProcesses:
    """Programs under the real rclpy in one domain of this computer.

    Args:
        environment: The environment with the real rclpy.
        folder: A folder for files of the run.
        programs: The programs, whose folders may contain packages of messages.
        report: Prints a line for the user.
        domain: The programs' ROS_DOMAIN_ID; 0 selects a free one.
        is_timed: Whether `end` is called after a given time, so that programs do not report it.
    """

    def __init__(
        self,
        environment: RealEnvironment,
        folder: Path,
        programs: Sequence[Path],
        report: Callable[[str], None],
        domain: int = 0,
        *,
        is_timed: bool = False,
    ) -> None:
        self._environment, self._report = environment, report
        self._used = folder / "used.txt"
        self._used.touch()
        profiles = folder / "loopback.xml"
        profiles.write_text(PROFILES, encoding="utf-8")
        packages, problems = missing_packages(environment.packages, programs)
        for problem in problems:
            report(problem)
        self.domain = domain or free_domain()
        self._settings = repr(
            {
                "kit": str(KIT),
                "python": sys.executable,
                "packages": packages,
                "used": str(self._used),
                "is_timed": is_timed,
                "parent": os.getpid(),
            }
        )
        self._variables = clean_variables() | {
            "FASTDDS_DEFAULT_PROFILES_FILE": str(profiles),
            "FASTRTPS_DEFAULT_PROFILES_FILE": str(profiles),
            # A crash in C or C++ code prints the lines of Python that called it.
            "PYTHONFAULTHANDLER": "1",
            "PYTHONUNBUFFERED": "1",
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_DOMAIN_ID": str(self.domain),
            "ROS_LOG_DIR": str(folder),
        }
        self.processes: list[subprocess.Popen[bytes]] = []
        # The programs' names by process id.
        self._names: dict[int, str] = {}
        self.is_ending = False

    def start(
        self,
        program: Path,
        arguments: Sequence[str] = (),
        *,
        subject: str = "-",
        streams: tuple[IO[str] | None, IO[str] | None] = (None, None),
    ) -> None:
        """Start a program with output to `streams`. If `subject` is given, it creates the nodes."""
        command = [self._environment.python, PROGRAM, self._settings, subject, program, *arguments]
        # Python ends with a fatal error if it is interrupted while it starts, so the program starts
        # with SIGINT blocked and unblocks it when its handler is installed.
        unblocked = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            process = subprocess.Popen(
                [str(word) for word in command],
                stdout=streams[0],
                stderr=streams[1],
                env=self._variables,
                # Ctrl+C reaches only this process, which passes it on once.
                start_new_session=True,
            )
            self.processes.append(process)
            self._names[process.pid] = program.name
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, unblocked)

    def are_running(self) -> bool:
        """Return whether a program still runs."""
        return any(process.poll() is None for process in self.processes)

    def end(self, advance: Callable[[], object]) -> int:
        """Interrupt the programs as Ctrl+C does. Return the first exit code other than 0.

        Args:
            advance: Called while the programs end, so that their last messages are recorded.
        """
        is_first_call, self.is_ending = not self.is_ending, True
        crashed = [one for one in self.processes if (one.poll() or 0) < 0]
        for one in crashed if is_first_call else ():
            name, cause = self._names[one.pid], signal.Signals(-one.returncode)
            self._report(
                f"{name} was ended by {cause.name} ({signal.strsignal(cause)}), as errors in C and C++ "
                f"do. If lines of Python are above, the first one of {name} contains the call."
            )
        for number, seconds in SIGNALS:
            running = [process for process in self.processes if process.poll() is None]
            if running and number != signal.SIGINT:
                self._report(f"A program did not end, so it got {number.name}.")
            for process in running:
                process.send_signal(number)
            deadline = wall.monotonic() + seconds
            while self.are_running() and wall.monotonic() < deadline:
                advance()
        # A program that does not handle the interrupt has ended as expected, as with `course run`.
        codes = [process.wait() for process in self.processes]
        failed = [code for code in codes if code not in (0, -signal.SIGINT)]
        return next((code if code > 0 else SIGNALED - code for code in failed), 0)

    def kit_packages(self) -> list[str]:
        """Return the imported packages that are from the kit, not from ROS."""
        return sorted(set(self._used.read_text(encoding="utf-8").split("\n")) - {""})


def free_domain() -> int:
    """Return a random domain without participants on this computer.

    Raises:
        CourseError: No free domain was found.
    """
    for domain in random.SystemRandom().sample(DOMAINS, TRIES):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            try:
                sock.bind(("", PORT + PORTS_OF_A_DOMAIN * domain))
                return domain
            except OSError:
                continue
    raise CourseError("No domain is free on this computer: end other ROS 2 programs first.")


def linked_graph(
    programs: RealProcesses, report: Callable[[str], None], *, sends: bool = False
) -> RobotGraph:
    """Return a graph that is linked to programs, which may start later.

    Args:
        programs: The programs, whose domain the graph joins.
        report: Prints the link's lines while nodes exist. Before and after, missing messages are
            normal.
        sends: Whether all topics may be published and all services called.
    """

    def report_while_linked(line: str) -> None:
        # A program leaves the network a moment before it ends.
        is_up = graph.nodes() and graph.link.is_up()
        if is_up and not programs.is_ending and programs.are_running():
            report(line)

    for name in WARM_TYPES:
        # Definitions are read now, because reading them takes a second in which the first messages
        # would be lost.
        type_hash(name)
    graph = RobotGraph(
        DdsLink(HOST, programs.domain), Permissions(allows_everything=sends), report_while_linked
    )
    return graph


@contextmanager
def temporary_folder() -> Iterator[Path]:
    """Provide a temporary folder for files of a run."""
    with tempfile.TemporaryDirectory(prefix="course-ros-") as folder:
        yield Path(folder)


def check_programs(files: Sequence[Path]) -> None:
    """Check that all files are Python programs that can run in separate processes.

    Raises:
        CourseError: A file is not such a program.
    """
    for file in files:
        if not file.is_file():
            raise CourseError(f"{file} is not a file. --ros runs Python programs, like my_node.py.")
        if file.suffix == ".ipynb":
            raise CourseError(
                f"{file}: --ros runs Python programs. Check a notebook with course check --ros, or export it."
            )
        if file.suffix != ".py" or file.name.endswith((".launch.py", "_launch.py")):
            raise CourseError(f"{file}: --ros runs Python programs only, as launch has no wheel.")
        if not os.access(file, os.R_OK):
            raise CourseError(f"You have no permission to read {file}: change its permissions, or copy it.")


# Period of checking whether the programs still run [ns].
STEP_NS = 2 * 10**7
# Time after which a program without a node counts as started [s].
NODE_SECONDS = 10.0
NOT_ROS_OWN = "Not ROS's own, but the kit's on the real rclpy"


@dataclass
class TopicTraffic:
    """Times of the messages on a topic."""

    type_name: str
    times_ns: list[int] = field(default_factory=list)

    def __str__(self) -> str:
        gaps = [(b - a) * 1e-9 for a, b in zip(self.times_ns, self.times_ns[1:], strict=False)]
        count = f"{len(self.times_ns)} message{'s' * (len(self.times_ns) != 1)}"
        if len(gaps) < 2 or not sum(gaps):
            return count
        spread = statistics.pstdev(gaps) * 1e3
        return f"{count}, {len(gaps) / sum(gaps):.2f} Hz, jitter {spread:.1f} ms"


def run_on_ros(
    files: Sequence[Path],
    *,
    seconds: float | None,
    bag: Path | None,
    arguments: Sequence[str],
    shows: bool,
) -> int:
    """Run programs under the real rclpy until they end, or for a time after their first node has started.

    Args:
        files: Python programs; each runs in a separate process.
        seconds: Wall-clock time from the first node, or from NODE_SECONDS on if there is none, [s];
            None waits for Ctrl+C or the programs' end.
        bag: Folder of the recording, which must not exist.
        arguments: The arguments in `sys.argv` of each program.
        shows: Whether the viewer displays them in a browser tab.

    Returns:
        The first exit code of a program that is not 0.

    Raises:
        CourseError: The real rclpy is not installed, or a file cannot be run.
    """
    check_programs(files)
    if bag is not None and bag.exists():
        raise CourseError(f"{bag} already exists. Choose another folder for the recording, or remove it.")
    environment = find_environment()
    import_path.install()
    traffic: dict[str, TopicTraffic] = {}

    def count(sample: Sample) -> None:
        if sample.topic not in OWN_TOPICS:
            traffic.setdefault(sample.topic, TopicTraffic(sample.type_name)).times_ns.append(sample.stamp_ns)

    exit_at_signals()
    with temporary_folder() as folder:
        programs = RealProcesses(environment, folder, files, print_to_stderr, is_timed=seconds is not None)
        graph = linked_graph(programs, print_to_stderr)
        print_to_stderr(f"{environment}, domain {programs.domain} on this computer's loopback.")
        graph.tap(count)
        try:
            with ExitStack() as stack:
                if bag is not None:
                    from course_lib.recording import record_to_bag

                    stack.enter_context(record_to_bag(graph, bag))
                stack.enter_context(use_graph(graph))
                for file in files:
                    programs.start(file, arguments)
                try:
                    _follow(graph, programs, seconds, shows=shows)
                except KeyboardInterrupt:
                    # As on a robot, Ctrl+C ends the programs.
                    print_to_stderr("")
                code = programs.end(graph.advance)
        finally:
            programs.end(graph.advance)
            graph.close()
        for topic, of_topic in sorted(traffic.items()):
            print_to_stderr(f"  {topic} [{of_topic.type_name}]: {of_topic}")
        if not traffic:
            print_to_stderr("  Nothing was published.")
        kits = programs.kit_packages()
        print_to_stderr(f"{NOT_ROS_OWN}: {', '.join(kits)}." if kits else "All packages were ROS's own.")
    return code


def _follow(graph: RobotGraph, programs: RealProcesses, seconds: float | None, *, shows: bool) -> None:
    """Run the graph until the programs end or the time is over."""
    first_node: float | None = None
    begin = wall.monotonic()
    with ExitStack() as stack:
        if shows:
            from course_lib.displays.viewer import Viewer

            virtual_time.install()
            viewer = Viewer()
            viewer.add("TF", show_names=True)
            viewer.open()
            print_to_stderr("Ctrl+C ends the programs.")
            stack.enter_context(time_lock.hold())
        while programs.are_running():
            if shows:
                time_lock.sleep_until(graph.now_ns + STEP_NS, "Ctrl+C")
            else:
                graph.advance()
            if first_node is None and graph.nodes():
                first_node = wall.monotonic()
            elif first_node is None and seconds is not None and wall.monotonic() - begin > NODE_SECONDS:
                print_to_stderr(f"No node has started for {NODE_SECONDS:g} s: --seconds begins now.")
                first_node = wall.monotonic()
            if seconds is not None and first_node is not None and wall.monotonic() - first_node >= seconds:
                return
