"""Replacements of `time`, sleeps, locks, threads and asyncio that follow robot time.

ROS programs are ordinary Python: they call `time.sleep`, start threads, wait for events and put
messages into queues. Each such wait must be a wait for robot time, because a thread that blocks in
the operating system would keep the time lock, and robot time would never advance again. So these
functions and classes are replaced, once, for the whole process. Every replacement checks whether
the calling thread is a program thread; for all other threads it calls the original, so Jupyter's
own threads keep to the wall clock.

A loop like `while not done: pass` contains no call of the kit, so robot time would stand still and
the loop would never end. A call that counts its rounds is compiled into such loops: after many
rounds it lets robot time advance. In a notebook, sleeps of a cell drive the live nodes.
"""

import _thread
import ast
import queue
import selectors
import signal
import sys
import threading
import time
from collections.abc import Callable
from importlib.machinery import SourceFileLoader
from itertools import count
from typing import TYPE_CHECKING, Any

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import START_NS, current_graph, program
from course_lib.ros.student_code import is_student_file
from course_lib.ros.time import wall
from course_lib.ros.time.time_lock import (
    POLL_STEP_NS,
    POLLS_BEFORE_TIME_PASSES,
    POLLS_PER_STEP,
    ProgramThread,
    ShutDown,
    StoppedThread,
    get_handler,
    set_handler,
    time_lock,
)
from course_lib.third_party import compile_python

if TYPE_CHECKING:
    from logging import LogRecord


class RunningCell:
    """The state of the running cell. `%load_ext course_lib` sets `drive`, which drives nodes."""

    def __init__(self) -> None:
        self.is_running = False
        self.drive: Callable[[float], bool] = lambda seconds: False

    def is_running_in_caller(self) -> bool:
        """Return whether the calling thread runs a cell."""
        return self.is_running and threading.current_thread() is threading.main_thread()

    def sleep(self, seconds: float) -> None:
        """Sleep [s]. Robot time advances if live nodes or threads of cells wait for it."""
        if not (self.is_running_in_caller() and self.drive(seconds)):
            wall.sleep(seconds)


cell = RunningCell()


_CALL = f"__import__({__name__!r}, fromlist=['count_round']).count_round()"
_rounds_in_cells = count(1)
_real_get_code = SourceFileLoader.get_code


class BusyWaitTransformer(ast.NodeTransformer):
    """Inserts a call of `count_round` into the waiting loops of a syntax tree.

    Also used as one of IPython's `ast_transformers`.
    """

    def visit(self, node: ast.AST) -> Any:
        """Insert a call of `count_round` into each loop of the tree that only waits."""
        # ast.walk does not recurse, so expressions may have thousands of terms.
        for loop in ast.walk(node):
            if not isinstance(loop, ast.While) or not _is_idle(loop.body):
                continue
            # `while True: pass` hangs in ROS as well, so it is left alone and reported.
            is_endless = isinstance(loop.test, ast.Constant) and loop.test.value
            may_end = not is_endless or any(isinstance(inner, ast.Break) for inner in ast.walk(loop))
            # A condition that awaits lets other coroutines run.
            yields = any(isinstance(p, (ast.Await, ast.Yield, ast.YieldFrom)) for p in ast.walk(loop.test))
            if may_end and not yields:
                (call,) = ast.parse(_CALL).body
                for inserted in ast.walk(call):
                    ast.copy_location(inserted, loop)
                loop.body.insert(0, call)
        return node


def _is_idle(statements: list[ast.stmt]) -> bool:
    """Return whether statements do nothing except leave the loop."""
    return all(
        isinstance(statement, (ast.Pass, ast.Continue, ast.Break))
        or (isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant))
        or (isinstance(statement, ast.If) and _is_idle(statement.body) and _is_idle(statement.orelse))
        for statement in statements
    )


def count_round() -> None:
    """Count a round of a waiting loop. After many rounds, let robot time advance."""
    if time_lock.is_program_thread():
        time_lock.poll(reads_clock=True)
    elif cell.is_running_in_caller():
        rounds = next(_rounds_in_cells)
        if rounds >= POLLS_BEFORE_TIME_PASSES and rounds % POLLS_PER_STEP == 0:
            cell.sleep(POLL_STEP_NS * 1e-9)


def compile_program(source: bytes, file: str) -> Any:
    """Compile a program's source. Raise the exceptions of `compile`."""
    tree = BusyWaitTransformer().visit(compile_python(source, file, ast.PyCF_ONLY_AST))
    try:
        return compile(tree, file, "exec", dont_inherit=True)
    except RecursionError:
        # Python compiles source that is nested more deeply than a syntax tree may be.
        return compile_python(source, file)


def _get_code(loader: SourceFileLoader, name: str) -> Any:
    """Return a module's code; a student's own is compiled with `compile_program` and not cached."""
    path = loader.get_filename(name)
    source = loader.get_data(path) if is_student_file(path) else b""
    return compile_program(source, path) if b"while" in source else _real_get_code(loader, name)


_real_start = threading.Thread.start
_real_join = threading.Thread.join
_real_select = selectors.DefaultSelector.select
_RealLock = threading.Lock
_RealRLock = threading.RLock
_RealSimpleQueue = queue.SimpleQueue
# Interval between attempts to take a lock that a thread outside of the program holds [s].
BRIEFLY = 0.001


def install() -> None:
    """Install the replacements. Calling it again has no effect."""
    if time.sleep is _sleep:
        return
    for name in ("time", "monotonic", "perf_counter"):
        origin_ns = 0 if name == "time" else START_NS
        setattr(time, name, _robot_clock(getattr(time, name), origin_ns, 1e-9))
        setattr(time, f"{name}_ns", _robot_clock(getattr(time, f"{name}_ns"), origin_ns, 1))
    from concurrent.futures.process import ProcessPoolExecutor
    from multiprocessing.pool import Pool, ThreadPool

    replacements: tuple[tuple[Any, str, Any], ...] = (
        (time, "sleep", _sleep),
        (SourceFileLoader, "get_code", _get_code),
        (signal, "signal", set_handler),
        (signal, "getsignal", get_handler),
        (threading, "Lock", Lock),
        (threading, "RLock", make_rlock),
        (threading, "_allocate_lock", make_waiter),
        # threading imports the function under this name, as queue does.
        (threading, "_time", time.monotonic),
        (threading.Thread, "start", _start_thread),
        (threading.Thread, "join", _join_thread),
        (queue, "time", time.monotonic),
        (queue, "SimpleQueue", SimpleQueue),
        (selectors.DefaultSelector, "select", _select),
        *(
            (pool, "_setup_queues", _reject_in_robot_time(vars(pool)["_setup_queues"]))
            for pool in (Pool, ThreadPool)
        ),
        (ProcessPoolExecutor, "__init__", _reject_in_robot_time(ProcessPoolExecutor.__init__)),
    )
    for owner, name, replacement in replacements:
        setattr(owner, name, replacement)
    streams = sys.modules.get("ipykernel.iostream")
    # Jupyter sends a kernel's output from a separate thread.
    if streams is not None:
        real_flush = streams.OutStream.flush

        def flush(*args: Any) -> Any:
            with time_lock.as_ordinary_thread():
                return real_flush(*args)

        streams.OutStream.flush = flush


def is_started_by_program(thread: threading.Thread) -> bool:
    """Return whether a program thread has started this thread."""
    return hasattr(thread, "_program_thread")


def _robot_clock(real: Callable[[], Any], origin_ns: int, unit: float) -> Callable[[], Any]:
    def now() -> Any:
        if not time_lock.is_program_thread():
            return real()
        time_lock.poll(reads_clock=True)
        return (current_graph().now_ns - origin_ns) * unit

    return now


def _sleep(*args: float) -> None:
    if len(args) != 1:
        # Python's own text, which does not contain the name of this function.
        raise TypeError(f"time.sleep() takes exactly one argument ({len(args)} given)")
    (seconds,) = args
    if not hasattr(seconds, "__float__") and not hasattr(seconds, "__index__"):
        raise TypeError(f"'{type(seconds).__name__}' object cannot be interpreted as an integer")
    if not time_lock.is_program_thread():
        cell.sleep(seconds)
        return
    if seconds < 0:
        raise ValueError("sleep length must be non-negative")
    with time_lock.polling():
        time_lock.sleep_until(current_graph().now_ns + round(seconds * 1e9), f"time.sleep({seconds:g})")


def _start_thread(thread: threading.Thread) -> None:
    """Start a thread.

    A thread started by a program thread is a program thread from its first line on.
    """
    if not time_lock.is_program_thread():
        _real_start(thread)
        return
    program_thread = time_lock.new_thread(thread.name)
    run, of_program = thread.run, program.name
    # A pool stores the exception that ends a thread as the result of its task, and logs it with a
    # traceback if a callback of the task asks for the result.
    if pools := sys.modules.get("concurrent.futures._base"):
        pools.LOGGER.addFilter(_is_worth_logging)

    def run_with_the_time_lock() -> None:
        program.name = of_program
        time_lock.enter(program_thread)
        try:
            run()
        except (StoppedThread, ShutDown):
            if not current_graph().ended:
                raise
        # Reported while the thread has its turn, so that the output of a run repeats.
        except Exception as error:
            hook_arguments = (type(error), error, error.__traceback__, thread)
            threading.excepthook(threading.ExceptHookArgs(hook_arguments))
        finally:
            time_lock.leave(program_thread)

    thread.run = run_with_the_time_lock  # type: ignore[method-assign]
    thread._program_thread = program_thread  # type: ignore[attr-defined]
    time_lock.enqueue(program_thread)
    try:
        with time_lock.as_ordinary_thread():
            _real_start(thread)
    # The system cannot create more threads.
    except RuntimeError:
        time_lock.dequeue(program_thread)
        raise


def _is_worth_logging(record: "LogRecord") -> bool:
    """Return whether a log record is not about an exception by which the end of a run ends a thread."""
    error = record.exc_info[1] if record.exc_info else None
    return not (isinstance(error, (StoppedThread, ShutDown)) and current_graph().ended)


def _join_thread(thread: threading.Thread, timeout: float | None = None) -> None:
    program_thread: ProgramThread | None = getattr(thread, "_program_thread", None)
    if program_thread is not None and time_lock.is_program_thread():
        until_ns = None if timeout is None else current_graph().now_ns + round(max(timeout, 0) * 1e9)
        awaited = f'the end of thread "{thread.name}"'
        if not time_lock.wait(
            lambda: program_thread.is_done, until_ns=until_ns, awaited=awaited, events_help=False
        ):
            return
    _real_join(thread, timeout)


def _select(selector: Any, timeout: float | None = None) -> Any:
    """Wait for files or for robot time. asyncio sleeps in this function."""
    if not time_lock.is_program_thread():
        return _real_select(selector, timeout)
    ready = _real_select(selector, 0)
    if ready or (timeout is not None and timeout <= 0):
        return ready
    until_ns = None if timeout is None else current_graph().now_ns + round(timeout * 1e9)
    time_lock.wait(lambda: bool(_real_select(selector, 0)), until_ns=until_ns, awaited="asyncio")
    return _real_select(selector, 0)


def _reject_in_robot_time(real: Callable[..., Any]) -> Callable[..., Any]:
    """Reject pools in robot time. Their threads would hold the time lock while they read pipes."""

    def make(*args: Any, **kwargs: Any) -> Any:
        if time_lock.is_program_thread():
            raise CourseError(
                "multiprocessing's pools and ProcessPoolExecutor would wait forever in robot time. "
                "Use concurrent.futures.ThreadPoolExecutor."
            )
        return real(*args, **kwargs)

    return make


class ProgramLock:
    """A lock created by a program thread.

    Event and Condition use locks with `returns_at_end`, whose `acquire` gives up at the end of the
    run. A mutex waits until the thread that holds it has finished.
    """

    def __init__(self, *, returns_at_end: bool = False) -> None:
        self._real = _thread.allocate_lock()
        self._returns_at_end = returns_at_end
        # Identifier of the thread that holds the lock, once it has been recorded.
        self._owner: int | None = None
        self._is_taken_by_program = False

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Acquire the lock as `threading.Lock` does. `timeout` is in [s] of robot time."""
        waits = blocking and time_lock.is_program_thread()
        is_acquired = self._wait(timeout) if waits else self._real.acquire(blocking, timeout)
        if is_acquired:
            self._owner, self._is_taken_by_program = _thread.get_ident(), time_lock.is_program_thread()
        return is_acquired

    def release(self) -> None:
        """Release the lock. Its owner is reset before another thread can acquire it."""
        if self._real.locked():
            self._owner, self._is_taken_by_program = None, False
        self._real.release()

    def locked(self) -> bool:
        """Return whether a thread holds the lock."""
        return self._real.locked()

    def _wait(self, timeout: float) -> bool:
        until_ns = None if timeout < 0 else current_graph().now_ns + round(timeout * 1e9)
        while not self._real.acquire(False):
            if self._is_held_outside():
                wall.sleep(BRIEFLY)
                continue
            is_free = time_lock.wait(
                lambda: not self._real.locked() or self._is_held_outside(),
                until_ns=until_ns,
                awaited="a lock",
                events_help=False,
            )
            if not is_free and (until_ns is not None or self._returns_at_end):
                return False
        return True

    def _is_held_outside(self) -> bool:
        """Return whether the holder follows the wall clock, because it is not a program thread at the moment.

        A program thread that has just acquired the lock has recorded it before any other thread can
        check.
        """
        if self._is_taken_by_program:
            return False
        return self._owner is None or not time_lock.is_program_thread(self._owner)

    def _at_fork_reinit(self) -> None:
        self._real = _thread.allocate_lock()

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, *_: object) -> None:
        self.release()


class Lock:
    """Replacement for `threading.Lock`: a ProgramLock if the program may use it, else a real lock."""

    def __new__(cls) -> Any:
        """Create the lock."""
        return ProgramLock() if _is_made_for_program() else _RealLock()


class SimpleQueue(_RealSimpleQueue[Any]):
    """Replacement for `queue.SimpleQueue`: the pure Python version, which uses our locks."""

    def __new__(cls) -> Any:
        """Create the queue."""
        if not _is_made_for_program():
            return super().__new__(cls)
        return queue._PySimpleQueue()  # type: ignore[attr-defined]  # the standard library's own fallback


def _is_made_for_program() -> bool:
    """Return whether the program may use an object that is created now, for example in a cell.

    `current_thread()` is not used because it would create an object with locks for a thread that
    Python has not started.
    """
    return time_lock.is_program_thread() or _thread.get_ident() == threading.main_thread().ident


def make_waiter() -> Any:
    """Create the lock with which a Condition waits."""
    return ProgramLock(returns_at_end=True) if time_lock.is_program_thread() else _thread.allocate_lock()


def make_rlock() -> Any:
    """Replacement for `threading.RLock`, based on a ProgramLock if the program may use it."""
    if not _is_made_for_program():
        return _RealRLock()
    rlock = threading._PyRLock()  # type: ignore[attr-defined]  # the standard library's RLock in Python
    rlock._block = ProgramLock()
    return rlock
