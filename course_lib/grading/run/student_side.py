"""The student's side of a scenario, in the worker and in a notebook's kernel."""

import _thread
import ctypes
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from functools import partial
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError
from course_lib.grading.evidence import Evidence
from course_lib.grading.run.outcome import (
    MAX_ERRORS,
    RAISED,
    BoundedOutput,
    Outcome,
    describe,
    plain,
    still_running_message,
)
from course_lib.grading.run.submission_run import Instructions, ScenarioGraph
from course_lib.grading.task import ON_A_GRAPH, Scenario, Task
from course_lib.ros.graph.graph import START_NS, Graph, current_graph, use_graph
from course_lib.ros.programs import import_path
from course_lib.ros.programs.program import seeded
from course_lib.ros.time import virtual_time
from course_lib.ros.time.time_lock import AtEnd, ShutDown, StoppedThread, time_lock
from course_lib.ros.tracebacks import line_of_thread, loop_of_traceback

# a single call without arguments, the default of launch tasks
ONE_CALL: Sequence[tuple[Sequence[Any], dict[str, Any]]] = (((), {}),)
WALL_LIMIT = 20.0  # [s] wall time of a run in this process


def perform(part: Instructions, subject: Any, graph: Graph, outcome: Outcome) -> None:
    """Run the student's object on a graph, and store returned values and errors in `outcome`.

    Raises:
        KeyboardInterrupt: The run was interrupted before its end.
    """
    import_path.install()
    virtual_time.install()
    with time_lock.hold(), use_graph(graph), seeded(part.seed):
        for action in _actions(part, subject, outcome):
            try:
                with time_lock.at_end(AtEnd.INTERRUPT):
                    action()
            except BaseException as error:
                # Student code may raise any exception, including SystemExit.
                is_end = graph.ended and isinstance(error, (KeyboardInterrupt, ShutDown, StoppedThread))
                # The end of the scenario acts like Ctrl+C, after which publishing and
                # `rclpy.shutdown()` raise, even in a `finally`. These errors must not count.
                if graph.ended and part.kind in ON_A_GRAPH:
                    continue
                if isinstance(error, KeyboardInterrupt) and not is_end:
                    raise
                problem = (
                    still_running_message((graph.now_ns - START_NS) / 1e9) if is_end else describe(error)
                )
                outcome.errors = [*outcome.errors, problem][:MAX_ERRORS]
        time_lock.finish_other_threads()


def _actions(part: Instructions, subject: Any, outcome: Outcome) -> list[Callable[[], None]]:
    if part.kind == "node":
        return [lambda: run_node(subject)]
    if part.kind == "launch":
        return [partial(_launch, subject, args, kwargs, outcome) for args, kwargs in part.calls or ONE_CALL]
    if part.kind == "file":
        return [lambda: outcome.returns.append(plain(Path(subject).read_text(encoding="utf-8")))]
    if part.kind != "function":
        return [lambda: outcome.returns.append(plain(subject))]

    def call(args: Sequence[Any], kwargs: dict[str, Any]) -> None:
        # A call that raises still needs an entry, so that later ones keep their index.
        outcome.returns.append(RAISED)
        outcome.returns[-1] = plain(_callable(subject, "a function")(*args, **kwargs))

    return [lambda a=args, k=kwargs: call(a, k) for args, kwargs in part.calls]  # type: ignore[misc]


def _launch(subject: Any, args: Sequence[Any], kwargs: dict[str, Any], outcome: Outcome) -> None:
    """Call the function and run the launch file that it returns.

    The subject may also be the text itself.
    """
    outcome.returns.append(RAISED)
    text = subject if isinstance(subject, str) else _callable(subject, "a function")(*args, **kwargs)
    if not isinstance(text, str) or not text.strip():
        outcome.returns[-1] = plain(text)
        return
    # Imported late, because it imports the stand-in for launch.
    from course_lib.grading.run.launching import launch

    outcome.returns[-1] = plain(launch(text).as_plain())


def run_node(make: Any) -> None:
    """Create the node or nodes and spin them.

    If the function returns None, it has spun them itself.
    """
    import rclpy
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
    from rclpy.node import Node
    from rclpy.signals import SignalHandlerOptions, uninstall_signal_handlers

    returned = _callable(make, "a node class")
    before = current_graph().nodes()
    # A function such as `main()` usually calls `rclpy.init()` itself.
    code = getattr(make, "__code__", None)
    if not (code is not None and "init" in code.co_names):
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    try:
        returned = returned()
        nodes = [returned] if isinstance(returned, Node) else list(returned or ())
        if nodes:
            executor = SingleThreadedExecutor()
            for node in nodes:
                executor.add_node(node)
            executor.spin()
        elif returned is None and current_graph().now_ns == START_NS and current_graph().nodes() == before:
            name = getattr(make, "__name__", "the function")
            raise CourseError(f"{name}() created no node, expected a class: class {name}(Node): …")
    except ExternalShutdownException:
        # The student's code called rclpy.shutdown(), which is a regular end.
        pass
    finally:
        uninstall_signal_handlers()


def _callable(subject: Any, expected: str) -> Callable[..., Any]:
    if not callable(subject):
        name = type(subject).__name__
        itself = "its name alone" if type(subject).__module__ == "builtins" else f"{name} itself"
        instead = f": pass {itself}, without ()"
        if isinstance(subject, str) and subject.isidentifier():
            instead = f": pass {subject} without quotes"
        raise CourseError(f"got an object of {name}, expected {expected}{instead}")
    function: Callable[..., Any] = subject
    return function


# The interrupt repeats after this time [s], for code that swallows the first one.
AGAIN = 1.0


class Watchdog:
    """A thread that interrupts a run after a time limit."""

    def __init__(self) -> None:
        self.has_fired = False
        self.line = ""  # location of a thread that was started during the run
        self._stopped = threading.Event()
        self._threads_before = set(threading.enumerate())

    def watch(self, seconds: float) -> None:
        """Interrupt after `seconds` of the wall clock, and repeat until the run is over."""
        while not self._stopped.wait(AGAIN if self.has_fired else seconds):
            self.has_fired = True
            for thread in set(threading.enumerate()) - self._threads_before - {threading.current_thread()}:
                self.line = self.line or line_of_thread(thread.ident or 0)
                end = ctypes.py_object(SystemExit)
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident or 0), end)
            # A real signal also interrupts a wait for a lock.
            if hasattr(signal, "pthread_kill"):
                signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
            else:
                _thread.interrupt_main()

    def stop(self) -> None:
        """Stop the watchdog's thread."""
        self._stopped.set()


@contextmanager
def watchdog(seconds: float) -> Iterator[Watchdog]:
    """Raise KeyboardInterrupt in the main thread after `seconds`, and end threads started in the block."""
    dog = Watchdog()
    thread = threading.Thread(target=dog.watch, args=(seconds,), daemon=True)
    with _enable_interrupts():
        thread.start()
        try:
            yield dog
        finally:
            dog.stop()
            thread.join()


@contextmanager
def _enable_interrupts() -> Iterator[None]:
    """Raise KeyboardInterrupt on SIGINT even if it is ignored, as in programs started by `nohup` or `&`."""
    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        yield
        return
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def run_in_this_process(
    task: Task,
    scenario: Scenario,
    subject: Any,
    personal: Mapping[str, Any],
    *,
    wall_limit: float = WALL_LIMIT,
) -> Evidence:
    """Run a scenario in this process, and interrupt it after `wall_limit` [s] of the wall clock."""
    stage, outcome, output = ScenarioGraph(task, scenario, personal), Outcome(), BoundedOutput()
    stopped = ""
    with redirect_stdout(output), redirect_stderr(output), watchdog(wall_limit) as dog:
        try:
            perform(stage.instructions, subject, stage.graph, outcome)
        except KeyboardInterrupt as interrupt:
            if not dog.has_fired:
                raise
            stopped = "time"
            line = loop_of_traceback(interrupt.__traceback__) or dog.line
            outcome.errors.append(still_running_message(wall_limit, line))
    return stage.evidence(outcome, output=output.getvalue(), stopped=stopped)
