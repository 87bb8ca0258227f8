"""Execution of programs with repeatable random numbers.

`random`, numpy, `uuid` and `os.urandom` are seeded for the length of a run, so a run with the same
seed repeats exactly.
"""

import os
import random
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import chdir, contextmanager, nullcontext
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np

from course_lib.ros.graph.graph import current_graph
from course_lib.ros.programs import import_path
from course_lib.ros.programs.package_programs import Executables, RunProgram
from course_lib.ros.programs.packages import LAUNCH_IN_WORDS
from course_lib.ros.programs.process import NotebookProgram, Process, Processes, Program
from course_lib.ros.student_code import is_student_file
from course_lib.ros.time import virtual_time
from course_lib.ros.time.interrupts import keep_signal_handlers
from course_lib.ros.time.time_lock import time_lock
from course_lib.ros.tracebacks import format_location, print_error_of_thread

_real_urandom = os.urandom
_real_seed = random.Random.seed


@contextmanager
def seed_generators(seed: int) -> Iterator[None]:
    """Seed all random generators that a program may use, and restore them after the block."""
    source = random.Random(seed)
    python_state, numpy_state = random.getstate(), np.random.get_state()
    random.seed(source.getrandbits(64))
    np.random.seed(source.getrandbits(32))

    def urandom(size: int, /) -> bytes:
        return source.randbytes(size) if time_lock.is_program_thread() else _real_urandom(size)

    def seed_generator(generator: random.Random, a: Any = None, version: int = 2) -> None:
        seed = source.getrandbits(64) if a is None and time_lock.is_program_thread() else a
        _real_seed(generator, seed, version)

    replacements: tuple[tuple[Any, str, Callable[..., Any]], ...] = (
        (os, "urandom", urandom),
        # random.SystemRandom and numpy use the function under this name.
        (random, "_urandom", urandom),
        (random.Random, "seed", seed_generator),
        # The generator behind the module's functions.
        (random, "seed", partial(seed_generator, random._inst)),
    )
    originals = [getattr(owner, name) for owner, name, _ in replacements]
    for owner, name, replacement in replacements:
        setattr(owner, name, replacement)
    try:
        yield
    finally:
        random.setstate(python_state)
        np.random.set_state(numpy_state)
        for (owner, name, _), original in zip(replacements, originals, strict=True):
            setattr(owner, name, original)


def run_files(
    files: Sequence[Path],
    *,
    seed: int,
    args: Sequence[str] = (),
    extra_processes: Sequence[Process] = (),
    kit_executables: "Executables | None" = None,
    is_strict: bool = False,
) -> int:
    """Run Python files, launch files and notebooks as if each were started alone, in the current graph.

    `PACKAGE_DIR:executable` is a program of the package in that folder. If all programs are
    notebooks of one folder, they work in that folder, as in Jupyter.

    Args:
        files: The programs.
        seed: Seeds the random number generators.
        args: Arguments that follow each program's name in `sys.argv`.
        extra_processes: Further processes, which are started last.
        kit_executables: Executables that launch files may start in addition to those of packages.
        is_strict: Whether a launch ends if something in it cannot run here; otherwise that is
            skipped.

    Raises:
        CourseError: A file cannot be run.

    Returns:
        The first exit code that is not 0, or 0.
    """
    import_path.install()
    virtual_time.install()
    executables = {} if kit_executables is None else kit_executables
    programs: list[Process] = [_program(file, args, executables, is_strict) for file in files]
    programs += extra_processes
    # With a robot, runs do not repeat, and each run needs different goal ids.
    seeded_or_not = nullcontext() if current_graph().keeps_wall_time else seed_generators(seed)
    folders = {p.file.resolve().parent if isinstance(p, NotebookProgram) else None for p in programs}
    folder = folders.pop() if len(folders) == 1 else None
    in_folder = nullcontext() if folder is None else chdir(folder)
    with _keep_interpreter_state(), in_folder, seeded_or_not, time_lock.hold():
        if len(programs) == 1:
            programs[0].run()
        else:
            processes = Processes()
            for process in programs:
                processes.start(process)
            processes.wait()
        # Wait for all non-daemon threads, as Python does at exit, then stop the others.
        graph = current_graph()
        for thread in threading.enumerate():
            if virtual_time.is_started_by_program(thread) and not thread.daemon:
                thread.join()
        graph.end_ns = graph.now_ns
        while graph.advance():
            pass
        time_lock.finish_other_threads()
    return next((p.exit_code for p in programs if p.exit_code), 0)


def _program(
    file: Path,
    args: Sequence[str],
    kit_executables: Executables,
    is_strict: bool,
) -> Process:
    if file.suffix == ".ipynb":
        return NotebookProgram(file)
    folder, _, executable = str(file).rpartition(":")
    if folder and (Path(folder) / "package.xml").is_file():
        return RunProgram(os.path.join(folder, ""), executable, args, kit_executables)
    if file.suffix not in LAUNCH_IN_WORDS and not (program := Program(file, args)).is_launch_file:
        return program
    # Imported late, because it imports the stand-in's launch.
    from course_lib.ros.programs.launch_program import LaunchProgram

    return LaunchProgram(file, args, kit_executables, is_strict=is_strict)


@contextmanager
def _keep_interpreter_state() -> Iterator[None]:
    """Restore `sys`, the environment and signal handlers after the block; report errors of threads."""
    interpreter_state = sys.argv, sys.path[:], sys.modules["__main__"]
    environment = dict(os.environ)
    threading.excepthook = print_error_of_thread
    with keep_signal_handlers():
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, partial(_exit_on_second_interrupt, []))
        try:
            yield
        finally:
            sys.argv, sys.path[:], sys.modules["__main__"] = interpreter_state
            os.environ.clear()
            # A launch file may have changed the environment.
            os.environ.update(environment)
            threading.excepthook = threading.__excepthook__


def _exit_on_second_interrupt(signals: list[int], number: int, frame: FrameType | None) -> None:
    """Handle SIGINT: the first one interrupts as usual, the second ends the process.

    `signals` keeps the signals that have been received.
    """
    signals.append(number)
    if len(signals) > 1:
        sys.stderr.write("Stopped at once.\n")
        sys.stderr.flush()
        os._exit(130)
    if frame is not None and is_student_file(frame.f_code.co_filename):
        line = format_location(frame.f_code.co_filename, frame.f_lineno)
        sys.stderr.write(
            f"interrupted in {line}\nhint: robot time passes only in calls of ROS, in time.sleep and in "
            "loops that do nothing. A loop that waits needs a line like time.sleep(0.01).\n"
        )
    signal.default_int_handler(number, frame)
