"""`ros2 launch` and `ros2 run`; in a notebook the processes go on between the cells, as with run_live."""

import threading
from argparse import REMAINDER, Namespace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.errors import CourseError
from course_lib.ros.baton import baton
from course_lib.ros.graph import Graph, current_graph
from course_lib.ros.live import LiveRun, go_live, live_runs
from course_lib.ros.package_programs import Executables, RunProgram
from course_lib.ros.packages import LAUNCH_IN_WORDS, find_package, why_not_found
from course_lib.ros.process import Processes
from course_lib.tools.sources import Source
from course_lib.tools.verb import Verb, Write, flag, value

if TYPE_CHECKING:
    from course_lib.ros.launch_program import LaunchProgram

_STOP_LIMIT_NS = 10**9  # of robot time that interrupted processes have to end


class LaunchedRun(LiveRun):
    """A launch file's processes, running between the cells; stopping it interrupts them."""

    def __init__(self, graph: Graph, program: "LaunchProgram | RunProgram") -> None:
        super().__init__(graph, ())
        self.file = program.file
        self._processes = Processes()
        with baton.known():
            self._processes.start(program)
            baton.wait(self.is_over, until_ns=graph.now_ns, what="the start of the launch")

    @property
    def name(self) -> str:
        """The launch file."""
        return self.file.name

    def is_over(self) -> bool:
        """Return whether all processes have ended."""
        return bool(self._processes.ended)

    def stop(self) -> None:
        """Interrupt each process, and wait until all have ended."""
        if self.running:
            super().stop()
            with baton.known():
                self._processes.interrupt()
                if threading.current_thread() is threading.main_thread():  # else nothing moves robot time
                    limit_ns = current_graph().now_ns + _STOP_LIMIT_NS
                    baton.wait(self.is_over, until_ns=limit_ns, what="the ends of the processes")


def launch_verbs(executables: Executables) -> tuple[Verb, Verb]:
    """Return `ros2 launch` and `ros2 run`, which find these executables beside those of packages."""
    launch, run = partial(_launch, executables), partial(_run, executables)
    return (
        Verb("launch", "", "Run a launch file", _LAUNCH, launch, from_start=True),
        Verb("run", "", "Run a package specific executable", _RUN, run, from_start=True),
    )


def _launch(executables: Executables, source: Source, arguments: Namespace, write: Write) -> None:
    from course_lib.ros.launch_program import LaunchProgram, arguments_of

    words = [arguments.package_name, *arguments.launch_file_name]
    named = find_package(words[0])
    if named is None and not Path(words[0]).is_file() and len(words) > 1 and ":=" not in words[1]:
        raise CourseError(why_not_found(words[0]))
    if named is not None and not Path(words[0]).is_file():
        file, settings = _in_package(named.share, words), words[2:]
    else:
        file, settings = Path(words[0]), words[1:]
    if not file.is_file():
        raise CourseError(
            f"No such launch file: {file}. Write ros2 launch PACKAGE FILE, or the path of a file."
        )
    if arguments.show_args:
        write(arguments_of(file) + "\n")
    else:
        _start(source, LaunchProgram(file, settings, executables))


def _in_package(share: Path, words: list[str]) -> Path:
    found = (path for suffix in (".py", *LAUNCH_IN_WORDS) for path in sorted(share.rglob(f"*{suffix}")))
    files = {path.name: path for path in found if "launch" in path.name}
    if len(words) > 1 and words[1] in files:
        return files[words[1]]
    raise CourseError(
        f"file '{words[1] if len(words) > 1 else ''}' was not found in the share directory of package "
        f"'{words[0]}' which is at '{share}'. There is: {', '.join(files) or 'no launch file'}."
    )


def _run(executables: Executables, source: Source, arguments: Namespace, write: Write) -> None:
    program = RunProgram(arguments.package_name, arguments.executable_name, arguments.argv, executables)
    _start(source, program)


def _start(source: Source, program: "LaunchProgram | RunProgram") -> None:
    """Run a program to its end; in a notebook start it, in place of an earlier run of the same file."""
    import rclpy

    graph = current_graph()
    if not source.live:
        raise CourseError("Nothing can be started in a recording. Do it in a notebook, or: course run FILE")
    if not graph.notebook:
        rclpy.try_shutdown()  # ros2's own; the program begins with none
        program.run()
        return
    for former in live_runs(graph):
        if isinstance(former, LaunchedRun) and former.file == program.file:
            former.stop()
    if not rclpy.ok():
        rclpy.init(args=[])
    run = LaunchedRun(graph, program)
    if not run.is_over():  # its description failed
        go_live(run)


_LAUNCH = (
    value("package_name", help="Name of the ROS package which contains the launch file, or its path"),
    value("launch_file_name", nargs="*", help="Name of the launch file, then its arguments: name:=value"),
    flag(
        "-s", "--show-args", "--show-arguments", help="Show arguments that may be given to the launch file."
    ),
)
_RUN = (
    value("package_name", help="Name of the ROS package"),
    value("executable_name", help="Name of the executable"),
    value("argv", nargs=REMAINDER, help="Pass arbitrary arguments to the executable"),
)
