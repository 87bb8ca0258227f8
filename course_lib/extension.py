"""`%load_ext course_lib`: the stand-in, robot time and the magics in a kernel."""

import asyncio
import gc
import signal
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

from course_lib.ros import standin_path, virtual_time, wall
from course_lib.ros.baton import baton
from course_lib.ros.cells import cell
from course_lib.ros.driving import drive_in_cell
from course_lib.ros.graph import current_graph
from course_lib.ros.idle_loops import IdleLoops
from course_lib.ros.live import drive_threads
from course_lib.ros.notices import repeated_lines, replacements

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell


_GARBAGE = (50_000, 20, 20)  # of gc.set_threshold: with Python's own, a million points take twice as long


def load(shell: "InteractiveShell") -> None:
    """Install the stand-in, robot time and the magics; a second call changes nothing."""
    standin_path.install()
    virtual_time.install()
    from course_lib.tools.notebook import register, shorten_tracebacks  # imports the stand-in's rclpy

    current_graph().notebook = True
    gc.set_threshold(*_GARBAGE)
    _prepare_jupyters_loop()
    if not any(isinstance(one, IdleLoops) for one in shell.ast_transformers):
        shell.ast_transformers.append(IdleLoops())
    cell.drive = drive_in_cell
    register(shell)
    shorten_tracebacks(shell)
    shell.events.register("pre_run_cell", _begin_cell)
    shell.events.register("post_run_cell", _end_cell)


def _begin_cell(*_: object) -> None:
    cell.runs = True
    replacements.waits = True


def _end_cell(*_: object) -> None:
    cell.runs = False
    drive_threads()
    repeated_lines.end()
    replacements.tell()
    replacements.waits = False


def _prepare_jupyters_loop() -> None:
    """Set the loop's clock: its thread, the main one, is on robot time during a call of the kit.

    A thread for which robot time stands still asks the loop to drive it.

    Any signal wakes it. ipykernel 7.4's handler for ■ in cells that await only adds to the loop's queue.
    """
    try:
        loop = asyncio.get_running_loop()
    except RuntimeError:  # no kernel: IPython's terminal, or the grader's worker
        return
    baton.stalled = partial(_drive_soon, loop)
    loop.time = wall.monotonic  # type: ignore[method-assign]  # one loop's clock, not every loop's
    if hasattr(signal, "SIGURG"):  # with a handler asyncio asks for its wake-up; Windows has none
        loop.add_signal_handler(signal.SIGURG, lambda: None)


def _drive_soon(loop: asyncio.AbstractEventLoop) -> None:
    with suppress(RuntimeError):  # the kernel ends
        loop.call_soon_threadsafe(drive_threads)
