"""Runs of unmodified rclpy programs, launch files and notebooks in this process, on robot time."""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, chdir, contextmanager, nullcontext
from pathlib import Path
from types import FrameType

from course_lib.ros import standin_path, virtual_time
from course_lib.ros.baton import baton
from course_lib.ros.graph import Graph, current_graph
from course_lib.ros.interrupts import signals_kept
from course_lib.ros.package_programs import Executables, RunProgram
from course_lib.ros.packages import LAUNCH_IN_WORDS
from course_lib.ros.process import NotebookProgram, Process, Processes, Program
from course_lib.ros.seeding import seeded
from course_lib.ros.tracebacks import is_own, name_line, print_error_of_thread


def run_files(
    files: Sequence[Path],
    *,
    seed: int,
    args: Sequence[str] = (),
    beside: Sequence[Process] = (),
    own: "Executables | None" = None,
) -> int:
    """Run Python, launch files and notebooks as if each were started alone; they share the current graph.

    `PACKAGE_DIR:executable` is a program of the package in that folder.

    `args` is what each finds in `sys.argv` behind its name; `beside` is started last; `own` are executables
    that launch files may start beside those of packages. Notebooks without other programs work in their
    folder, as in Jupyter. A CourseError says which file cannot be run. Returns the first exit code that is
    not 0.
    """
    standin_path.install()
    virtual_time.install()
    programs: list[Process] = [_program(file, args, own or {}) for file in files]
    programs += beside
    # What happens at a robot does not repeat, and the ids of goals must differ from those of other runs.
    chance = nullcontext() if current_graph().keeps_wall_time else seeded(seed)
    with _interpreter_kept(), _folder_of_notebooks(programs), chance, baton.known():
        if len(programs) == 1:
            programs[0].run()
        else:
            processes = Processes()
            for one in programs:
                processes.start(one)
            processes.wait()
        _finish(current_graph())
    return next((p.exit_code for p in programs if p.exit_code), 0)


def _program(file: Path, args: Sequence[str], own: Executables) -> Process:
    if file.suffix == ".ipynb":
        return NotebookProgram(file)
    folder, _, executable = str(file).rpartition(":")
    if folder and (Path(folder) / "package.xml").is_file():
        return RunProgram(os.path.join(folder, ""), executable, args, own)
    if file.suffix not in LAUNCH_IN_WORDS and not (program := Program(file, args)).is_launch_file:
        return program
    from course_lib.ros.launch_program import LaunchProgram  # it imports launch, the stand-in's

    return LaunchProgram(file, args, own)


def _folder_of_notebooks(programs: Sequence[Process]) -> AbstractContextManager[None]:
    """Work in the folder of the programs, where all are notebooks of one folder."""
    folders = {p.file.resolve().parent if isinstance(p, NotebookProgram) else None for p in programs}
    folder = folders.pop() if len(folders) == 1 else None
    return nullcontext() if folder is None else chdir(folder)


@contextmanager
def _interpreter_kept() -> Iterator[None]:
    before = sys.argv, sys.path[:], sys.modules["__main__"]
    environment = dict(os.environ)
    threading.excepthook = print_error_of_thread
    with signals_kept():
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, _ends_at_the_second())
        try:
            yield
        finally:
            sys.argv, sys.path[:], sys.modules["__main__"] = before
            os.environ.clear()
            os.environ.update(environment)  # a launch file may have changed it
            threading.excepthook = threading.__excepthook__


def _ends_at_the_second() -> Callable[[int, FrameType | None], None]:
    """Return a handler of Ctrl+C: the first one interrupts as usual, the next one ends the process."""
    came: list[int] = []

    def handle(number: int, frame: FrameType | None) -> None:
        came.append(number)
        if len(came) > 1:
            sys.stderr.write("Stopped at once.\n")
            sys.stderr.flush()
            os._exit(130)
        if frame is not None and is_own(frame.f_code.co_filename):
            line = name_line(frame.f_code.co_filename, frame.f_lineno)
            sys.stderr.write(
                f"interrupted in {line}\nhint: robot time passes only in calls of ROS, in time.sleep and in "
                "loops that do nothing. A loop that waits needs a line like time.sleep(0.01).\n"
            )
        signal.default_int_handler(number, frame)

    return handle


def _finish(graph: Graph) -> None:
    """End as Python ends: when the threads that are not daemons have ended; then stop the others."""
    for thread in threading.enumerate():
        if virtual_time.is_of_the_program(thread) and not thread.daemon:
            thread.join()
    graph.end_ns = graph.now_ns
    while graph.advance():
        pass
    baton.let_others_finish()
