"""`course run my_node.py --ros`: runs the same file on the real ROS 2.

The kit displays and records it.
"""

import statistics
import sys
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path

from course_lib.errors import CourseError
from course_lib.real.environment import find_environment
from course_lib.real.process import RealProcesses, check_programs, linked_graph, temporary_folder
from course_lib.ros.graph.graph import Sample, use_graph
from course_lib.ros.graph.topics import OWN_TOPICS
from course_lib.ros.programs import import_path
from course_lib.ros.robot.robot_graph import RobotGraph
from course_lib.ros.time import virtual_time, wall
from course_lib.ros.time.time_lock import time_lock

# Period of checking whether the programs still run [ns].
STEP_NS = 2 * 10**7
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
        seconds: Wall-clock time, [s]; None waits for Ctrl+C or the programs' end.
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

    with temporary_folder() as folder:
        programs = RealProcesses(environment, folder, files, _report, is_timed=seconds is not None)
        graph = linked_graph(programs, _report)
        _report(f"{environment}, domain {programs.domain} on this computer's loopback.")
        graph.tap(count)
        try:
            with _recording(graph, bag), use_graph(graph):
                for file in files:
                    programs.start(file, arguments)
                _follow(graph, programs, seconds, shows=shows)
                code = programs.end(graph.advance)
        finally:
            programs.end(graph.advance)
            graph.close()
        for topic, one in sorted(traffic.items()):
            _report(f"  {topic} [{one.type_name}]: {one}")
        if not traffic:
            _report("  Nothing was published.")
        kits = programs.packages_of_the_kit()
        _report(f"{NOT_ROS_OWN}: {', '.join(kits)}." if kits else "All packages were ROS's own.")
    return code


def _recording(graph: RobotGraph, bag: Path | None) -> AbstractContextManager[object]:
    if bag is None:
        return nullcontext()
    from course_lib.recording import recorded

    return recorded(graph, bag)


def _follow(graph: RobotGraph, programs: RealProcesses, seconds: float | None, *, shows: bool) -> None:
    """Run the graph until the programs end, the time is over or Ctrl+C."""
    advance: Callable[[], object] = graph.advance
    try:
        if shows:
            from course_lib.displays.viewer import Viewer

            virtual_time.install()
            viewer = Viewer()
            viewer.add("TF", show_names=True)
            viewer.open()
            _report("Ctrl+C ends the programs.")
            with time_lock.hold():
                _drive(
                    graph, programs, seconds, lambda: time_lock.sleep_until(graph.now_ns + STEP_NS, "Ctrl+C")
                )
        else:
            _drive(graph, programs, seconds, advance)
    except KeyboardInterrupt:
        # As on a robot, Ctrl+C ends the programs.
        _report("")


def _drive(
    graph: RobotGraph, programs: RealProcesses, seconds: float | None, advance: Callable[[], object]
) -> None:
    first_node: float | None = None
    while programs.are_running():
        advance()
        if first_node is None and graph.nodes():
            first_node = wall.monotonic()
        if seconds is not None and first_node is not None and wall.monotonic() - first_node >= seconds:
            return


def _report(line: str) -> None:
    """Print a line of the kit to standard error, apart from the output of the programs."""
    sys.stderr.write(f"{line}\n")
    sys.stderr.flush()
