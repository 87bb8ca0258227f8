"""Runs unmodified rclpy programs in this process, on robot time."""

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType, ModuleType
from typing import Protocol

from course_lib.errors import CourseError
from course_lib.ros import standin_path, virtual_time
from course_lib.ros.baton import DeadlockError, baton
from course_lib.ros.graph import Graph, current_graph, program
from course_lib.ros.notebook_program import NotebookProgram
from course_lib.ros.seeding import seeded
from course_lib.ros.stopped import StoppedProgram, StoppedThread
from course_lib.ros.tracebacks import print_error, print_error_of_thread


class Runnable(Protocol):
    """What runs as a program of its own."""

    file: Path
    exit_code: int

    def run(self) -> None:
        """Run to its end."""


def run_files(
    files: Sequence[Path], *, seed: int, args: Sequence[str] = (), beside: Sequence[Runnable] = ()
) -> int:
    """Run Python files and notebooks as if each were started on its own; they share the current graph.

    Args:
        files: The programs in their start order; a CourseError says which cannot be run.
        seed: Seeds every source of chance.
        args: What each finds in `sys.argv` behind its name.
        beside: What else runs beside them, started last.

    Returns the first exit code that is not 0.
    """
    standin_path.install()
    virtual_time.install()
    programs: list[Runnable] = [
        NotebookProgram(file) if file.suffix == ".ipynb" else Program(file, args) for file in files
    ]
    programs += beside
    with _interpreter_kept(), seeded(seed), baton.known():
        if len(programs) == 1:
            programs[0].run()
        else:
            _run_beside_each_other(programs)
        _finish(current_graph())
    return next((p.exit_code for p in programs if p.exit_code), 0)


class Program:
    """One file with its own `__main__`; `args` is what it finds in `sys.argv` behind its name."""

    def __init__(self, file: Path, args: Sequence[str]) -> None:
        self.file = file
        self.exit_code = 0
        self._argv = [str(file), *args]
        try:
            self._code = compile(file.read_bytes(), str(file), "exec")
        except (OSError, ValueError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            raise CourseError(f"{file} cannot be run: {reason}. Give the path of a Python file.") from error
        except SyntaxError as error:
            raise CourseError(f"{file}, line {error.lineno}: {error.msg}.") from error

    def run(self) -> None:
        """Run the program to its end; what it raises is shown as Python shows it."""
        module = ModuleType("__main__")
        module.__file__ = str(self.file)
        sys.modules["__main__"] = module
        sys.argv = self._argv
        sys.path.insert(1, str(self.file.resolve().parent))  # behind the stand-in
        try:
            exec(self._code, module.__dict__)
        except (StoppedProgram, StoppedThread):
            sys.stderr.write(f"{self.file.name} was stopped: it went on waiting after the end of the run.\n")
        except SystemExit as leaving:
            self.exit_code = _exit_code(leaving.code)
        except KeyboardInterrupt:
            self.exit_code = 0 if current_graph().ended else 130
        except BaseException as error:
            print_error(error)
            self.exit_code = 1


@contextmanager
def _interpreter_kept() -> Iterator[None]:
    before = sys.argv, sys.path[:], sys.modules["__main__"]
    threading.excepthook = print_error_of_thread
    on_interrupt = signal.getsignal(signal.SIGINT)
    if on_interrupt is signal.default_int_handler:
        signal.signal(signal.SIGINT, _ends_at_the_second())
    try:
        yield
    finally:
        from rclpy.signals import uninstall_signal_handlers

        uninstall_signal_handlers()  # a program that never shut down has left them; they remember ours
        sys.argv, sys.path[:], sys.modules["__main__"] = before
        threading.excepthook = threading.__excepthook__
        if on_interrupt is signal.default_int_handler:
            signal.signal(signal.SIGINT, on_interrupt)


def _ends_at_the_second() -> Callable[[int, FrameType | None], None]:
    """Make a handler of Ctrl+C: the first one interrupts as ever, the next one ends whatever is stuck."""
    came: list[int] = []

    def handle(number: int, frame: FrameType | None) -> None:
        came.append(number)
        if len(came) > 1:
            sys.stderr.write("Stopped at once.\n")
            sys.stderr.flush()
            os._exit(130)
        signal.default_int_handler(number, frame)

    return handle


def _run_beside_each_other(programs: Sequence[Runnable]) -> None:
    threads = []
    for number, one in enumerate(programs):
        program.name = f"{number}: {one.file}"  # the same file may run twice
        threads.append(threading.Thread(target=one.run, name=one.file.name))
        threads[-1].start()
    program.name = ""
    try:
        _join(threads)
    except (KeyboardInterrupt, DeadlockError) as reason:
        for thread in threads:  # each gets Ctrl+C, as if it had a process of its own
            baton.interrupt(thread)
        _join(threads)
        if isinstance(reason, DeadlockError):
            raise


def _join(threads: Sequence[threading.Thread]) -> None:
    for thread in threads:
        thread.join()


def _exit_code(code: object) -> int:
    """Give what Python makes of `sys.exit(code)`: a text is printed, and means 1."""
    if code is None or isinstance(code, int):
        return code or 0
    sys.stderr.write(f"{code}\n")
    return 1


def _finish(graph: Graph) -> None:
    """End as Python ends: when the threads that are not daemons have ended; then stop the others."""
    for thread in threading.enumerate():
        if virtual_time.is_of_the_program(thread) and not thread.daemon:
            thread.join()
    graph.end_ns = graph.now_ns
    while graph.advance():
        pass
    baton.let_others_finish()
