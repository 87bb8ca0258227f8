"""Programs as processes: each has its own command line and exit code, in a thread of this process."""

import ast
import contextvars
import sys
import threading
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError
from course_lib.foreign import read_json
from course_lib.ros.baton import DeadlockError, baton
from course_lib.ros.graph import NodesOfProgram, current_graph, program
from course_lib.ros.idle_loops import IdleLoops, compiled
from course_lib.ros.packages import python_package, python_path, source
from course_lib.ros.program_thread import AtEnd, ShutDown, StoppedProgram, StoppedThread
from course_lib.ros.tracebacks import print_error

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

INTERRUPTED = 130  # a shell's exit code for Ctrl+C


class Process:
    """One program, called like a file; `args` is what it finds in `sys.argv` behind that."""

    at_end = AtEnd.INTERRUPT

    def __init__(self, file: Path, args: Sequence[str] = ()) -> None:
        self.file = file
        self.exit_code = 0
        self.argv = [str(file), *args]

    def work(self) -> None:
        """Run the program until it ends."""
        raise NotImplementedError

    def run(self) -> None:
        """Run the program to its end; what it raises is shown as Python shows it."""
        sys.argv = self.argv
        try:
            with baton.at_end(self.at_end):
                self.work()
        except (StoppedProgram, StoppedThread):
            sys.stderr.write(f"{self.file.name} was stopped: it went on waiting after the end of the run.\n")
        except SystemExit as leaving:
            self.exit_code = _exit_code(leaving.code)
        except KeyboardInterrupt:
            self.exit_code = 0 if current_graph().ended else INTERRUPTED
        except BaseException as error:
            if not (isinstance(error, ShutDown) and current_graph().ended):
                print_error(error)
                self.exit_code = 1


class Function(Process):
    """A program that is a function; as in a console script, what it returns is the exit code."""

    def __init__(
        self,
        name: str,
        function: Callable[[], object],
        args: Sequence[str],
        *,
        at_end: AtEnd = AtEnd.INTERRUPT,
    ) -> None:
        super().__init__(Path(name), args)
        self._function = function
        self.at_end = at_end

    def work(self) -> None:
        """Call it."""
        sys.exit(self._function())  # type: ignore[arg-type]  # it takes any object


class Program(Process):
    """One file with its own `__main__`; `args` is what it finds in `sys.argv` behind its name."""

    def __init__(self, file: Path, args: Sequence[str]) -> None:
        super().__init__(file, args)
        try:
            source = file.read_bytes()
            self._code = compiled(source, str(file))
        except (OSError, ValueError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            raise CourseError(f"{file} cannot be run: {reason}. Give the path of a Python file.") from error
        except SyntaxError as error:
            raise CourseError(f"{file}, line {error.lineno}: {error.msg}.") from error
        self._only_defines_main = _only_defines_main(ast.parse(source))

    @property
    def is_launch_file(self) -> bool:
        """True if the file describes a launch, by its name or by the function that `ros2 launch` calls."""
        named = self.file.name.endswith((".launch.py", "_launch.py"))
        return named or "generate_launch_description" in self._code.co_names

    def work(self) -> None:
        """Run the file; where it only defines `main`, call that, as its console script does."""
        module = ModuleType("__main__")
        module.__file__ = str(self.file)
        sys.modules["__main__"] = module
        sys.path.insert(1, str(self.file.resolve().parent))  # behind the stand-in
        source(self.file)
        sys.path += [place for place in python_path(self.file) if place not in sys.path]
        module.__package__ = python_package(self.file)
        exec(self._code, module.__dict__)
        if self._only_defines_main:
            sys.exit(module.__dict__["main"]())


_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Assign, ast.AnnAssign)
_IMPORTS = (ast.Import, ast.ImportFrom, ast.Try)


def _only_defines_main(tree: ast.Module) -> bool:
    """Return whether a file defines a function `main` and no statement of it runs anything."""
    statements = [node for node in tree.body if not _is_text(node)]
    has_main = any(isinstance(node, ast.FunctionDef) and node.name == "main" for node in statements)
    return has_main and all(isinstance(node, (*_DEFINITIONS, *_IMPORTS)) for node in statements)


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


class NotebookProgram(Process):
    """The code cells of a notebook of format 4, in order, up to the first that fails."""

    at_end = AtEnd.RETURN  # later cells look at what came before

    def __init__(self, file: Path) -> None:
        super().__init__(file)
        self._folder = str(file.resolve().parent)  # before the working directory changes
        try:
            cells = read_json(file.read_bytes())["cells"]
            self._sources = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        except OSError as error:
            raise CourseError(f"{file} cannot be run: {error.strerror}.") from error
        except (ValueError, KeyError, TypeError) as error:
            raise CourseError(
                f"{file} is not a notebook of format 4. Save it again in JupyterLab."
            ) from error

    def work(self) -> None:
        """Run the cells; IPython shows what one raises."""
        sys.path.insert(1, self._folder)  # as JupyterLab does
        shell = make_shell()
        for cell in self._sources:
            if not shell.run_cell(cell).success:  # type: ignore[no-untyped-call]  # IPython annotates little
                self.exit_code = 1
                return


class NothingKept(dict[int, list[Any]]):
    """In place of IPython's list of each cell's outputs, which an endless loop would let grow without end."""

    def __missing__(self, cell: int) -> list[Any]:
        """Return a list that nothing else holds."""
        return []


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
                with _event_loop():
                    process.run()
            finally:
                _remove_nodes()
                self.ended.append(number)

        daemon = graph.notebook  # a kernel ends without waiting for them
        context = contextvars.copy_context()  # its output belongs to this cell, whatever pages send meanwhile
        self._threads.append(
            threading.Thread(target=context.run, args=(run,), name=process.file.name, daemon=daemon)
        )
        graph.programs += 1
        program.name = f"{graph.programs}: {process.file}"  # the same one may run twice
        try:
            self._threads[-1].start()
        finally:
            program.name = before
        return number

    def interrupt(self, numbers: Collection[int] | None = None) -> None:
        """Interrupt each that runs, or only those of some numbers, as Ctrl+C does."""
        for number, thread in enumerate(self._threads):
            if number not in self.ended and (numbers is None or number in numbers):
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


@contextmanager
def _event_loop() -> Iterator[None]:
    """Set an event loop for the calling thread, as a process has one for `asyncio.get_event_loop()`."""
    import asyncio  # programs that run alone do not need it

    loop = asyncio.new_event_loop()
    asyncio.set_event_loop(loop)
    try:
        yield
    finally:
        loop.close()


def _remove_nodes() -> None:
    """Remove the nodes that the calling program has not destroyed: their process is gone."""
    for node in current_graph().part(NodesOfProgram).ids:
        current_graph().remove_node(node)


def _exit_code(code: object) -> int:
    """Return the exit code that Python makes of `sys.exit(code)`: a text is printed, and means 1."""
    if code is None or isinstance(code, int):
        return code or 0
    sys.stderr.write(f"{code}\n")
    return 1


def make_shell() -> "InteractiveShell":
    """An IPython shell without history, colours or a page."""
    from IPython.core.displayhook import DisplayHook
    from IPython.core.interactiveshell import InteractiveShell
    from traitlets.config import Config

    class Quiet(DisplayHook):
        def write_output_prompt(self) -> None:
            """Results stand alone, without `Out[1]:`."""

    class Shell(InteractiveShell):
        displayhook_class = Quiet

        def enable_gui(self, gui: Any = None) -> None:
            """Do nothing: there is no window, and `%matplotlib inline` is not a mistake."""

    config = Config()
    config.HistoryManager.enabled = False
    config.InteractiveShell.colors = "nocolor"
    InteractiveShell.clear_instance()  # that of another notebook in this process
    shell = Shell.instance(config=config)
    shell.ast_transformers.append(IdleLoops())
    if shell.history_manager is not None:  # it never is
        shell.history_manager.outputs = NothingKept()
    return shell
