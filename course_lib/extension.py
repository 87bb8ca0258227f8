"""`%load_ext course_lib`: installs the stand-in, robot time and the magics in a kernel."""

import asyncio
import gc
import signal
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

from course_lib.ros.graph.graph import current_graph
from course_lib.ros.notices import repeated_lines, replacements
from course_lib.ros.programs import import_path
from course_lib.ros.time import virtual_time, wall
from course_lib.ros.time.driving import drive_in_cell, drive_threads
from course_lib.ros.time.time_lock import time_lock
from course_lib.ros.time.virtual_time import BusyWaitTransformer, cell

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell


# Argument of gc.set_threshold. With Python's default, a million points take twice as long.
_GARBAGE = (50_000, 20, 20)


def load(shell: "InteractiveShell") -> None:
    """Install the stand-in, robot time and the magics. A second call has no effect."""
    import_path.install()
    virtual_time.install()
    # Imported here because this imports the stand-in's rclpy.
    from course_lib.tools.notebook import register, shorten_tracebacks

    current_graph().notebook = True
    gc.set_threshold(*_GARBAGE)
    _prepare_jupyters_loop()
    if not any(isinstance(transformer, BusyWaitTransformer) for transformer in shell.ast_transformers):
        shell.ast_transformers.append(BusyWaitTransformer())
    cell.drive = drive_in_cell
    register(shell)
    shorten_tracebacks(shell)
    shell.events.register("pre_run_cell", _begin_cell)
    shell.events.register("post_run_cell", _end_cell)


def _begin_cell(*_: object) -> None:
    cell.is_running = True
    replacements.is_deferred = True


def _end_cell(*_: object) -> None:
    cell.is_running = False
    drive_threads()
    repeated_lines.end()
    replacements.report()
    replacements.is_deferred = False


def _prepare_jupyters_loop() -> None:
    """Set the clock and the signal handling of Jupyter's event loop.

    During a call of the kit, the main thread, which runs the loop, is in robot time, but the loop
    needs real time. A thread for which robot time stands still asks the loop to advance it.

    Any signal must wake the loop, because ipykernel 7.4's handler of ■ only adds to the loop's
    queue while a cell awaits.
    """
    try:
        loop = asyncio.get_running_loop()
    # Without a kernel: IPython in a terminal, or a worker of the grader.
    except RuntimeError:
        return
    time_lock.on_stall = partial(_drive_soon, loop)
    # Only this loop's clock is changed.
    loop.time = wall.monotonic  # type: ignore[method-assign]
    # Signal handlers of asyncio are not available on Windows.
    if hasattr(signal, "SIGURG"):
        loop.add_signal_handler(signal.SIGURG, lambda: None)


def _drive_soon(loop: asyncio.AbstractEventLoop) -> None:
    # The loop is closed when the kernel ends.
    with suppress(RuntimeError):
        loop.call_soon_threadsafe(drive_threads)
