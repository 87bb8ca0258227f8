"""The student's side of a scenario, in the worker and in the kernel."""

import _thread
import ctypes
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

from course_lib.errors import CourseError
from course_lib.grading.evidence import Evidence
from course_lib.grading.run.outcome import (
    MAX_ERRORS,
    RAISED,
    Bounded,
    Outcome,
    describe,
    plain,
    still_running,
)
from course_lib.grading.run.scenario_graph import Instructions, ScenarioGraph
from course_lib.grading.task import Scenario, Task
from course_lib.ros import standin_path, virtual_time
from course_lib.ros.baton import baton
from course_lib.ros.clock import START_NS
from course_lib.ros.graph import Graph, use_graph
from course_lib.ros.program_thread import AtEnd, ShutDown, StoppedThread
from course_lib.ros.seeding import seeded
from course_lib.ros.tracebacks import line_of_thread, line_of_traceback

WALL_LIMIT = 20.0  # [s] of the wall clock for a run in this process


def perform(part: Instructions, subject: Any, graph: Graph, outcome: Outcome) -> None:
    """Run the student's object on a graph; whatever it returns or raises goes into `outcome`.

    Raises:
        KeyboardInterrupt: The run was interrupted before its end.
    """
    standin_path.install()
    virtual_time.install()
    with baton.known(), use_graph(graph), seeded(part.seed):
        for action in _actions(part, subject, outcome):
            try:
                with baton.at_end(AtEnd.INTERRUPT):
                    action()
            except BaseException as error:  # the student's code may raise anything, SystemExit too
                is_end = graph.ended and isinstance(error, (KeyboardInterrupt, ShutDown, StoppedThread))
                if is_end and part.kind == "node":
                    continue
                if isinstance(error, KeyboardInterrupt) and not is_end:
                    raise
                said = still_running((graph.now_ns - START_NS) / 1e9) if is_end else describe(error)
                outcome.errors = [*outcome.errors, said][:MAX_ERRORS]
        baton.let_others_finish()


def _actions(part: Instructions, subject: Any, outcome: Outcome) -> list[Callable[[], None]]:
    if part.kind == "node":
        return [lambda: run_node(subject)]
    if part.kind == "file":
        return [lambda: outcome.returns.append(plain(Path(subject).read_text(encoding="utf-8")))]
    if part.kind != "function":
        return [lambda: outcome.returns.append(plain(subject))]

    def call(args: Sequence[Any], kwargs: dict[str, Any]) -> None:
        outcome.returns.append(RAISED)  # so that a call that raises keeps its place
        outcome.returns[-1] = plain(_callable(subject, "a function")(*args, **kwargs))

    return [lambda a=args, k=kwargs: call(a, k) for args, kwargs in part.calls]  # type: ignore[misc]


def run_node(make: Any) -> None:
    """Create the node, or the nodes, and spin them; a function that returns None has run itself."""
    import rclpy
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
    from rclpy.node import Node
    from rclpy.signals import SignalHandlerOptions, uninstall_signal_handlers

    made = _callable(make, "a node class")
    if not _initialises(make):
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    try:
        made = made()
        nodes = [made] if isinstance(made, Node) else list(made or ())
        if nodes:
            executor = SingleThreadedExecutor()
            for node in nodes:
                executor.add_node(node)
            executor.spin()
    except ExternalShutdownException:
        pass  # the student's code called rclpy.shutdown(): an end like any other
    finally:
        uninstall_signal_handlers()


def _initialises(make: Any) -> bool:
    """Return whether a function calls `rclpy.init()` itself, as every `main()` does."""
    code = getattr(make, "__code__", None)
    return code is not None and "init" in code.co_names


def _callable(subject: Any, expected: str) -> Callable[..., Any]:
    if not callable(subject):
        name = type(subject).__name__
        instead = "" if type(subject).__module__ == "builtins" else f": give {name} itself, without ()"
        raise CourseError(f"got an object of {name}, expected {expected}{instead}")
    made: Callable[..., Any] = subject
    return made


AGAIN = 1.0  # [s] code that swallows an interrupt gets another one


class Watchdog:
    """A thread that interrupts a run after a time limit."""

    def __init__(self) -> None:
        self.barked = False
        self.line = ""  # that a thread started meanwhile was in
        self._over = threading.Event()
        self._older = set(threading.enumerate())

    def watch(self, seconds: float) -> None:
        """Interrupt after `seconds` of the wall clock, and again until the run is over."""
        while not self._over.wait(AGAIN if self.barked else seconds):
            self.barked = True
            for thread in set(threading.enumerate()) - self._older - {threading.current_thread()}:
                self.line = self.line or line_of_thread(thread.ident or 0)
                end = ctypes.py_object(SystemExit)
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident or 0), end)
            if hasattr(signal, "pthread_kill"):  # a real signal: it also ends a wait for a lock
                signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
            else:
                _thread.interrupt_main()

    def stop(self) -> None:
        """End the thread."""
        self._over.set()


@contextmanager
def watchdog(seconds: float) -> Iterator[Watchdog]:
    """Raise KeyboardInterrupt in the main thread, and end threads started meanwhile, after so many [s]."""
    dog = Watchdog()
    thread = threading.Thread(target=dog.watch, args=(seconds,), daemon=True)
    with _interrupts_heard():
        thread.start()
        try:
            yield dog
        finally:
            dog.stop()
            thread.join()


@contextmanager
def _interrupts_heard() -> Iterator[None]:
    """Raise KeyboardInterrupt on SIGINT where it is ignored: `nohup` and a script's `&` start programs so."""
    is_main = threading.current_thread() is threading.main_thread()
    if not is_main or signal.getsignal(signal.SIGINT) is not signal.SIG_IGN:
        yield
        return
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def run_here(
    task: Task,
    scenario: Scenario,
    subject: Any,
    personal: Mapping[str, Any],
    *,
    wall_limit: float = WALL_LIMIT,
) -> Evidence:
    """Run a scenario in this process, interrupted after `wall_limit` [s] of the wall clock."""
    stage, outcome, output = ScenarioGraph(task, scenario, personal), Outcome(), Bounded()
    stopped = ""
    with redirect_stdout(output), redirect_stderr(output), watchdog(wall_limit) as dog:
        try:
            perform(stage.part, subject, stage.graph, outcome)
        except KeyboardInterrupt as interrupt:
            if not dog.barked:
                raise
            stopped = "time"
            line = line_of_traceback(interrupt.__traceback__) or dog.line
            outcome.errors.append(still_running(wall_limit, line))
    return stage.evidence(outcome, output=output.getvalue(), stopped=stopped)
