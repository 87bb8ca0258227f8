"""`%load_ext course_lib`: the stand-in, robot time and the magics in a kernel."""

import asyncio
import gc
from typing import TYPE_CHECKING

from course_lib.ros import standin_path, virtual_time, wall
from course_lib.ros.graph import current_graph
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
    _keep_jupyters_loop_on_the_wall_clock()
    register(shell)
    shorten_tracebacks(shell)
    shell.events.register("pre_run_cell", _begin_cell)
    shell.events.register("post_run_cell", _end_cell)


def _begin_cell(*_: object) -> None:
    replacements.waits = True


def _end_cell(*_: object) -> None:
    repeated_lines.end()
    replacements.tell()
    replacements.waits = False


def _keep_jupyters_loop_on_the_wall_clock() -> None:
    """Set the loop's clock: its thread, the main one, is on robot time during a call of the kit."""
    try:
        loop = asyncio.get_running_loop()
    except RuntimeError:  # no kernel: IPython's terminal, or the grader's worker
        return
    loop.time = wall.monotonic  # type: ignore[method-assign]  # one loop's clock, not every loop's
