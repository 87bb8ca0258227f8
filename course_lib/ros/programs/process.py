"""Programs as processes, each a thread of this process with its own command line and exit code."""

import ast
import contextvars
import os
import sys
import threading
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError, join_words
from course_lib.ros.graph.graph import ProgramNodes, current_graph, program
from course_lib.ros.programs.packages import python_package, python_path, source
from course_lib.ros.syntax_hints import syntax_hint
from course_lib.ros.time.time_lock import (
    DeadlockError,
    EndBehavior,
    ShutDown,
    StoppedProgram,
    StoppedThread,
    time_lock,
)
from course_lib.ros.time.virtual_time import BusyWaitTransformer, compile_program
from course_lib.ros.tracebacks import print_error, was_explained
from course_lib.third_party import compile_python, read_bytes, read_json

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell

# The exit code that a shell reports after Ctrl+C.
INTERRUPTED = 130


class Process:
    """A program, started like a file. `args` follow its name in `sys.argv`."""

    at_end = EndBehavior.INTERRUPT

    def __init__(self, file: Path, args: Sequence[str] = ()) -> None:
        self.file = file
        self.exit_code = 0
        self.argv = [str(file), *args]

    def work(self) -> None:
        """Run the program until it ends."""
        raise NotImplementedError

    def run(self) -> None:
        """Run the program until it ends. Print an uncaught exception as Python does."""
        sys.argv = self.argv
        try:
            with time_lock.at_end(self.at_end):
                self.work()
        except (StoppedProgram, StoppedThread):
            sys.stderr.write(
                f"{self.file.name} was stopped: it was still waiting after the end of the run.\n"
            )
        except SystemExit as end:
            if end.code is None or isinstance(end.code, int):
                self.exit_code = end.code or 0
            else:
                # As in Python, a string is printed, and the exit code is 1.
                sys.stderr.write(f"{end.code}\n")
                self.exit_code = 1
        except KeyboardInterrupt:
            self.exit_code = 0 if current_graph().ended else INTERRUPTED
        except BaseException as error:
            if not (isinstance(error, ShutDown) and current_graph().ended):
                print_error(error)
                self.exit_code = 1
        if self.exit_code or was_explained() or isinstance(self, NotebookProgram):
            return
        # Nodes with timers or subscriptions that were not spun.
        nodes = current_graph().state(ProgramNodes)
        if unspun := [name for name, count in nodes.callbacks.items() if count > 0]:
            sys.stderr.write(
                f"{self.file.name} ended without a spin of {join_words(unspun)}.\nhint: timers and "
                "subscriptions call their functions only while the node is spun, as by rclpy.spin(node).\n"
            )
        # ROS ignores arguments without effect.
        for slip in dict.fromkeys(slip for find in nodes.find_slips for slip in find()):
            sys.stderr.write(f"hint: {self.file.name}: {slip}\n")


class FunctionProcess(Process):
    """A program that consists of a function.

    As in a console script, its return value is the exit code.
    """

    def __init__(
        self,
        name: str,
        function: Callable[[], object],
        args: Sequence[str],
        *,
        at_end: EndBehavior = EndBehavior.INTERRUPT,
    ) -> None:
        super().__init__(Path(name), args)
        self._function = function
        self.at_end = at_end

    def work(self) -> None:
        """Call the function."""
        sys.exit(self._function())  # type: ignore[arg-type]  # it takes any object


class Program(Process):
    """A Python file, run as `__main__`. `args` follow its name in `sys.argv`."""

    def __init__(self, file: Path, args: Sequence[str]) -> None:
        super().__init__(file, args)
        try:
            source = read_bytes(file)
            self._code = compile_program(source, str(file))
            tree = compile_python(source, str(file), ast.PyCF_ONLY_AST)
            self._only_defines_main = _only_defines_main(tree)
            self._idle_hint = _idle_hint(tree)
            # A file that runs nothing has a hint about the same line.
            self._slips = [] if self._idle_hint else list(_find_slips(tree))
        except (OSError, ValueError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            raise CourseError(f"{file} cannot be run: {reason}. Pass the path of a Python file.") from error
        except SyntaxError as error:
            hint = syntax_hint(error)
            text = f"{file}, line {error.lineno}: {error.msg}."
            raise CourseError(f"{text}\nhint: {hint}" if hint else text) from error

    def run(self) -> None:
        """Run the file, and print hints about its statements that do nothing."""
        super().run()
        # A file that ran nothing already has its hint.
        for slip in () if self._idle_hint else self._slips:
            sys.stderr.write(f"hint: {self.file.name}, {slip}\n")

    @property
    def is_launch_file(self) -> bool:
        """True if the file is a launch file, by its name or by the function it defines."""
        has_launch_name = self.file.name.endswith((".launch.py", "_launch.py"))
        return has_launch_name or "generate_launch_description" in self._code.co_names

    def work(self) -> None:
        """Run the file. If it only defines `main`, call that, as its console script does."""
        module = ModuleType("__main__")
        module.__file__ = str(self.file)
        sys.modules["__main__"] = module
        # The stand-in's packages stay first.
        sys.path.insert(1, str(self.file.resolve().parent))
        source(self.file)
        sys.path += [path for path in python_path(self.file) if path not in sys.path]
        if package := python_package(self.file):
            module.__package__ = package
            # The file may have the name of its package: an import of that name means the package.
            sys.path.insert(1, str(self.file.resolve().parents[package.count(".") + 1]))
        exec(self._code, module.__dict__)
        if self._only_defines_main:
            sys.exit(module.__dict__["main"]())
        if self._idle_hint:
            sys.stderr.write(f"{self.file.name} ran nothing.\nhint: {self._idle_hint}\n")


_DEFINITIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.Assign, ast.AnnAssign)
_IMPORTS = (ast.Import, ast.ImportFrom, ast.Try)


def _only_defines_main(tree: ast.Module) -> bool:
    """Return whether a file defines a function `main` and executes nothing on import."""
    has_main = any(isinstance(node, ast.FunctionDef) and node.name == "main" for node in tree.body)
    return has_main and all(
        isinstance(node, (*_DEFINITIONS, *_IMPORTS))
        # A docstring, or another constant.
        or (isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant))
        for node in tree.body
    )


# Functions and methods that are called for their effect.
_EFFECTS = {
    *("spin", "spin_once", "publish", "sendTransform", "init", "shutdown", "try_shutdown", "destroy_node"),
    *("succeed", "abort", "canceled", "start", "join", "main", "reset", "cancel", "notify_all"),
}

_VALUES = {"publish": "message", "sendTransform": "transform", "spin_once": "timeout_sec=0.1"}

# Functions and methods whose results are conditions. Without ( ) such a condition is always true.
_CONDITIONS = {
    *("done", "wait_for_service", "service_is_ready", "wait_for_server", "server_is_ready"),
    *("can_transform", "is_canceled", "is_ready", "is_alive", "is_set"),
}


def _find_slips(tree: ast.Module) -> Iterator[str]:
    """Yield hints about functions that are named without a call, and about targets of threads."""
    own_attributes = {
        node.attr
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)
    }
    for node in ast.walk(tree):
        match node:
            case ast.While(test=test) | ast.If(test=test) | ast.Assert(test=test):
                for part in test.values if isinstance(test, ast.BoolOp) else [test]:
                    operand = part.operand if isinstance(part, ast.UnaryOp) else part
                    text, name = ast.unparse(operand), getattr(operand, "attr", "")
                    # For `ok` the module is compared as well, because other objects have a field of
                    # this name.
                    if text == "rclpy.ok" or name in _CONDITIONS - own_attributes:
                        yield f"line {operand.lineno} names {text} and does not call it. Write: {text}()"
            case ast.Expr(ast.Attribute(attr=name) | ast.Name(name)) if name in _EFFECTS:
                text = ast.unparse(node.value)
                value = "node" if text == "rclpy.spin" else _VALUES.get(name, "")
                yield f"line {node.lineno} names {text} and does not call it. Write: {text}({value})"
            case ast.Call(ast.Name("Thread") | ast.Attribute(attr="Thread"), keywords=keywords):
                for keyword in keywords:
                    call = keyword.value
                    if keyword.arg != "target" or not isinstance(call, ast.Call):
                        continue
                    name = ast.unparse(call.func)
                    if name.rpartition(".")[2] in _EFFECTS:
                        values = "".join(f"{ast.unparse(value)}, " for value in call.args)
                        arguments = f", args=({values.removesuffix(' ')})" if values else ""
                        yield (
                            f"line {call.lineno} calls {name} here, and not in the thread. "
                            f"Write: Thread(target={name}{arguments})"
                        )
            case _:
                pass


def _idle_hint(tree: ast.Module) -> str:
    """Return a hint for a file that only defines functions and a node class, or ""."""
    nodes, guards = list[str](), list[tuple[int, str]]()
    for statement in tree.body:
        match statement:
            case ast.ClassDef(name=name, bases=bases):
                nodes += [name for base in bases if ast.unparse(base).endswith("Node")]
            case ast.If(test=ast.Compare(ast.Name("__name__"), [ast.Eq()], [ast.Constant(str(name))])) if (
                name != "__main__"
            ):
                guards.append((statement.lineno, name))
            case ast.If(body=[ast.Expr(ast.Name(name))]):
                line = statement.body[0].lineno
                return f"line {line} names {name} and does not call it. Write: {name}()"
            case ast.FunctionDef() | ast.Import() | ast.ImportFrom() | ast.Try():
                pass
            case ast.Assign() | ast.AnnAssign() | ast.Expr() if not any(
                isinstance(node, ast.Call) for node in ast.walk(statement)
            ):
                pass
            case _:
                return ""
    if guards:
        line, name = guards[0]
        return (
            f'line {line} compares __name__ with "{name}", and Python names a started program '
            '"__main__". Write: if __name__ == "__main__":'
        )
    if not nodes or _only_defines_main(tree):
        return ""
    return f"it only defines {nodes[-1]}. Write at its end: rclpy.init(), then rclpy.spin({nodes[-1]}())."


class NotebookProgram(Process):
    """The code cells of a notebook of format 4, run in order until one fails."""

    # Later cells examine the results of earlier ones.
    at_end = EndBehavior.RETURN

    def __init__(self, file: Path) -> None:
        super().__init__(file)
        # Resolved before the working directory changes.
        self._folder = os.path.dirname(os.path.realpath(file))
        try:
            cells = read_json(read_bytes(file))["cells"]
            self._sources = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
        except OSError as error:
            raise CourseError(
                f"{file} cannot be run: {error.strerror}. Pass the path of a notebook."
            ) from error
        except (ValueError, KeyError, TypeError) as error:
            raise CourseError(
                f"{file} is not a notebook of format 4. Save it again in JupyterLab."
            ) from error

    def work(self) -> None:
        """Run the cells. IPython prints an uncaught exception."""
        # JupyterLab adds the folder, too.
        sys.path.insert(1, self._folder)
        shell = make_shell()
        for cell in self._sources:
            if not shell.run_cell(cell).success:
                self.exit_code = 1
                return


class DiscardedOutputs(dict[int, list[Any]]):
    """Replaces IPython's list of each cell's outputs and stores nothing.

    In an endless loop that list would grow without limit.
    """

    def __missing__(self, cell: int) -> list[Any]:
        """Return a new list that nothing else refers to."""
        return []


@dataclass
class Processes:
    """Processes that share the graph, each in its own thread."""

    # Indices of the processes that have ended, in the order of their ends.
    ended: list[int] = field(default_factory=list)
    _threads: list[threading.Thread] = field(default_factory=list)

    def start(self, process: Process) -> int:
        """Start a process, which runs when the calling thread waits. Return its index."""
        number, previous_name = len(self._threads), program.name
        graph = current_graph()

        def run() -> None:
            # Imported late, because programs that run alone do not need it.
            import asyncio

            # The program's `asyncio.get_event_loop()` returns it.
            loop = asyncio.new_event_loop()
            asyncio.set_event_loop(loop)
            try:
                process.run()
            finally:
                loop.close()
                # Nodes that the program has not destroyed are gone, as they are with a real
                # process.
                for node in current_graph().state(ProgramNodes).ids:
                    current_graph().remove_node(node)
                self.ended.append(number)

        # A kernel exits without waiting for these threads.
        daemon = graph.notebook
        # With a copy of the context, output goes to this cell even
        # if pages send messages during the run.
        context = contextvars.copy_context()
        self._threads.append(
            threading.Thread(target=context.run, args=(run,), name=process.file.name, daemon=daemon)
        )
        graph.programs += 1
        # Numbered, because the same file may run twice.
        program.name = f"{graph.programs}: {process.file}"
        try:
            self._threads[-1].start()
        finally:
            program.name = previous_name
        return number

    def interrupt(self, numbers: Collection[int] | None = None) -> None:
        """Interrupt all running processes, or only the given indices, as Ctrl+C does."""
        for number, thread in enumerate(self._threads):
            if number not in self.ended and (numbers is None or number in numbers):
                time_lock.interrupt(thread)

    def wait(self) -> None:
        """Wait until all have ended. Ctrl+C and a deadlock interrupt all of them."""
        try:
            for thread in self._threads:
                thread.join()
        except (KeyboardInterrupt, DeadlockError) as reason:
            self.interrupt()
            for thread in self._threads:
                thread.join()
            if isinstance(reason, DeadlockError):
                raise


def make_shell() -> "InteractiveShell":
    """Create an IPython shell without history, colors or a page."""
    from IPython.core.displayhook import DisplayHook
    from IPython.core.formatters import DisplayFormatter
    from IPython.core.interactiveshell import InteractiveShell
    from traitlets.config import Config

    class Quiet(DisplayHook):
        def write_output_prompt(self) -> None:
            """Print nothing: results have no prompt such as `Out[1]:`."""

    class TextFormatter(DisplayFormatter):
        def format(self, obj: Any, include: Any = None, exclude: Any = None) -> Any:
            """Return only the text of an object, because pictures take long and are not shown."""
            return super().format(obj, {"text/plain"}, exclude)  # type: ignore[no-untyped-call]  # as IPython

    class Shell(InteractiveShell):
        displayhook_class = Quiet

        def init_display_formatter(self) -> None:
            """Use the formatter of a shell without pages."""
            self.display_formatter = TextFormatter(parent=self)
            self.configurables.append(self.display_formatter)  # type: ignore[arg-type]

        def enable_gui(self, gui: Any = None) -> None:
            """Do nothing, so that `%matplotlib inline` is accepted although there is no window."""

    config = Config()
    config.HistoryManager.enabled = False
    config.InteractiveShell.colors = "nocolor"
    # Another notebook in this process may have left its instance.
    InteractiveShell.clear_instance()
    shell = Shell.instance(config=config)
    shell.ast_transformers.append(BusyWaitTransformer())
    # Always true, but IPython annotates the attribute as optional.
    if shell.history_manager is not None:
        shell.history_manager.outputs = DiscardedOutputs()
    return shell
