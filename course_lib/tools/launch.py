"""`ros2 launch` and `ros2 run`.

In a notebook their processes continue between the cells, as with run_live.
"""

import sys
import threading
from argparse import REMAINDER, Namespace
from functools import partial
from itertools import pairwise, takewhile
from pathlib import Path
from typing import TYPE_CHECKING

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph, current_graph
from course_lib.ros.programs.package_programs import Executables, RunProgram
from course_lib.ros.programs.packages import LAUNCH_IN_WORDS, find_package, not_found_reason
from course_lib.ros.programs.process import Processes
from course_lib.ros.time.driving import LiveRun, live_runs, start_live_run
from course_lib.ros.time.time_lock import time_lock
from course_lib.tools.sources import Source
from course_lib.tools.verb import COURSE_OPTIONS, Verb, Write, flag, value

if TYPE_CHECKING:
    from course_lib.ros.programs.launch_program import LaunchProgram

# Robot time in which interrupted processes must end.
_STOP_LIMIT_NS = 10**9


class LaunchedRun(LiveRun):
    """The processes of a launch file, which run between the cells.

    Stopping the run interrupts them.
    """

    def __init__(self, graph: Graph, program: "LaunchProgram | RunProgram") -> None:
        super().__init__(graph, ())
        self.file = program.file
        self._processes = Processes()
        with time_lock.hold():
            self._processes.start(program)
            time_lock.wait(self.is_over, until_ns=graph.now_ns, awaited="the start of the launch")

    @property
    def name(self) -> str:
        """The name of the launch file."""
        return self.file.name

    def is_over(self) -> bool:
        """Return whether all processes have ended."""
        return bool(self._processes.ended)

    def stop(self) -> None:
        """Interrupt all processes and wait until they have ended."""
        if self.is_running:
            super().stop()
            with time_lock.hold():
                self._processes.interrupt()
                # In another thread, nothing would advance robot time.
                if threading.current_thread() is threading.main_thread():
                    limit_ns = current_graph().now_ns + _STOP_LIMIT_NS
                    time_lock.wait(self.is_over, until_ns=limit_ns, awaited="the ends of the processes")


def launch_verbs(executables: Executables) -> tuple[Verb, Verb]:
    """Return `ros2 launch` and `ros2 run`, which also find these executables."""
    launch, run = partial(_launch, executables), partial(_run, executables)
    return (
        Verb("launch", "", "Run a launch file", _LAUNCH, launch, is_immediate=True),
        Verb("run", "", "Run a package specific executable", _RUN, run, is_immediate=True),
    )


def _launch(executables: Executables, source: Source, arguments: Namespace, write: Write) -> None:
    from course_lib.ros.programs.launch_program import LaunchProgram, arguments_of

    launch_arguments = [arguments.package_name, *arguments.launch_file_name]
    package = find_package(launch_arguments[0])
    if (
        package is None
        and not Path(launch_arguments[0]).is_file()
        and len(launch_arguments) > 1
        and ":=" not in launch_arguments[1]
    ):
        raise CourseError(not_found_reason(launch_arguments[0]))
    if package is not None and not Path(launch_arguments[0]).is_file():
        share = package.share
        launch_files = (
            path for suffix in (".py", *LAUNCH_IN_WORDS) for path in sorted(share.rglob(f"*{suffix}"))
        )
        # As in ROS, a launch file may have any name. Only files in a `launch` folder or named so are
        # listed.
        files = {path.name: path for path in launch_files}
        name = launch_arguments[1] if len(launch_arguments) > 1 else ""
        if name not in files:
            names = [name for name, path in files.items() if "launch" in str(path.relative_to(share))]
            raise CourseError(
                f"file '{name}' was not found in the share directory of package "
                f"'{launch_arguments[0]}' which is at '{share}'. There is: "
                f"{', '.join(names) or 'no launch file'}."
            )
        file, settings = files[name], launch_arguments[2:]
    else:
        file, settings = Path(launch_arguments[0]), launch_arguments[1:]
    if not file.is_file():
        raise CourseError(
            f"No such launch file: {file}. Write ros2 launch PACKAGE FILE, or the path of a file."
        )
    if arguments.show_args:
        write(arguments_of(file) + "\n")
    else:
        _start(source, LaunchProgram(file, settings, executables, is_strict=arguments.strict))


def _run(executables: Executables, source: Source, arguments: Namespace, write: Write) -> None:
    program = RunProgram(arguments.package_name, arguments.executable_name, arguments.argv, executables)
    if not current_graph().notebook:
        # Options of `course ros2` that follow the program's name are passed to the program.
        launch_arguments = list(takewhile(lambda argument: argument != "--ros-args", arguments.argv))
        for option, number in pairwise([*launch_arguments, "…"]):
            if option in COURSE_OPTIONS:
                sys.stderr.write(
                    f"hint: {option} is passed to {arguments.executable_name}. To pass it to course, "
                    f"write it first: course ros2 {option} {number} run {arguments.package_name} …\n"
                )
    _start(source, program)


def _start(source: Source, program: "LaunchProgram | RunProgram") -> None:
    """Run a program to its end.

    In a notebook, start it and stop an earlier run of the same file.
    """
    import rclpy

    graph = current_graph()
    if not source.is_live:
        raise CourseError("A recording cannot start programs. Use a notebook, or: course run FILE")
    if not graph.notebook:
        # The context of the ros2 command itself: the program starts without one.
        rclpy.try_shutdown()
        program.run()
        if program.exit_code:
            # As in ROS, the command exits with the exit code of the program.
            sys.exit(program.exit_code)
        return
    for earlier_run in live_runs(graph):
        if isinstance(earlier_run, LaunchedRun) and earlier_run.file == program.file:
            earlier_run.stop()
    if not rclpy.ok():
        rclpy.init(args=[])
    run = LaunchedRun(graph, program)
    # The run is already over if its launch description failed.
    if not run.is_over():
        start_live_run(run)


_LAUNCH = (
    value("package_name", help="Name of the ROS package which contains the launch file, or its path"),
    value("launch_file_name", nargs="*", help="Name of the launch file, then its arguments: name:=value"),
    flag(
        "-s", "--show-args", "--show-arguments", help="Show arguments that may be given to the launch file."
    ),
    flag(
        "--strict",
        help="Fail if the launch file refers to anything that cannot run here, instead of skipping it.",
    ),
)
_RUN = (
    value("package_name", help="Name of the ROS package"),
    value("executable_name", help="Name of the executable"),
    value("argv", nargs=REMAINDER, help="Pass arbitrary arguments to the executable"),
)
