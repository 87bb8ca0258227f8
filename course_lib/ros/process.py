"""What programs run in: each has a command line and an exit code of its own, in a thread of this process."""

import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path

from course_lib.ros.baton import DeadlockError, baton
from course_lib.ros.graph import NodesOfProgram, current_graph, program
from course_lib.ros.program_thread import StoppedProgram, StoppedThread
from course_lib.ros.tracebacks import print_error

INTERRUPTED = 130  # a shell's exit code for Ctrl+C


class Process:
    """One program, called like a file; `args` is what it finds in `sys.argv` behind that."""

    def __init__(self, file: Path, args: Sequence[str] = ()) -> None:
        self.file = file
        self.exit_code = 0
        self.argv = [str(file), *args]

    def work(self) -> None:
        """Be the program."""
        raise NotImplementedError

    def run(self) -> None:
        """Run the program to its end; what it raises is shown as Python shows it."""
        sys.argv = self.argv
        try:
            self.work()
        except (StoppedProgram, StoppedThread):
            sys.stderr.write(f"{self.file.name} was stopped: it went on waiting after the end of the run.\n")
        except SystemExit as leaving:
            self.exit_code = _exit_code(leaving.code)
        except KeyboardInterrupt:
            self.exit_code = 0 if current_graph().ended else INTERRUPTED
        except BaseException as error:
            print_error(error)
            self.exit_code = 1


class Function(Process):
    """A program that is a function; as in a console script, what it returns is the exit code."""

    def __init__(self, name: str, function: Callable[[], object], args: Sequence[str]) -> None:
        super().__init__(Path(name), args)
        self._function = function

    def work(self) -> None:
        """Call it."""
        sys.exit(self._function())  # type: ignore[arg-type]  # it takes any object


class Processes:
    """Processes that share the graph, each in a thread of its own."""

    def __init__(self) -> None:
        self.ended: list[int] = []  # their numbers, as they ended
        self._threads: list[threading.Thread] = []

    def start(self, process: Process) -> int:
        """Start one, which runs when the calling thread waits; returns its number."""
        number, before = len(self._threads), program.name
        graph = current_graph()

        def run() -> None:
            try:
                process.run()
            finally:
                _remove_nodes()
                self.ended.append(number)

        daemon = graph.notebook  # a kernel ends without waiting for them
        self._threads.append(threading.Thread(target=run, name=process.file.name, daemon=daemon))
        graph.programs += 1
        program.name = f"{graph.programs}: {process.file}"  # the same one may run twice
        try:
            self._threads[-1].start()
        finally:
            program.name = before
        return number

    def interrupt(self) -> None:
        """Give each that runs Ctrl+C, as if it had an operating system's process of its own."""
        for number, thread in enumerate(self._threads):
            if number not in self.ended:
                baton.interrupt(thread)

    def wait(self) -> None:
        """Wait for their ends; Ctrl+C and a deadlock interrupt all of them."""
        try:
            self._join()
        except (KeyboardInterrupt, DeadlockError) as reason:
            self.interrupt()
            self._join()
            if isinstance(reason, DeadlockError):
                raise

    def _join(self) -> None:
        for thread in self._threads:
            thread.join()


def _remove_nodes() -> None:
    """Remove the nodes that the calling program has not destroyed: their process is gone."""
    for node in current_graph().part(NodesOfProgram).ids:
        current_graph().remove_node(node)


def _exit_code(code: object) -> int:
    """Give what Python makes of `sys.exit(code)`: a text is printed, and means 1."""
    if code is None or isinstance(code, int):
        return code or 0
    sys.stderr.write(f"{code}\n")
    return 1
