"""What `%load_ext course_lib` does to a kernel."""

import asyncio
from typing import TYPE_CHECKING

from course_lib.ros import standin_path, virtual_time, wall
from course_lib.ros.graph import current_graph
from course_lib.ros.notices import repeated_lines

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell


def load(shell: "InteractiveShell") -> None:
    """Put the stand-in, robot time and the magics in place; loading again changes nothing."""
    standin_path.install()
    virtual_time.install()
    from course_lib.tools.magic import register  # it imports rclpy, the stand-in's
    from course_lib.tools.tracebacks import shorten

    current_graph().notebook = True
    _keep_jupyters_loop_on_the_wall_clock()
    register(shell)
    shorten(shell)
    shell.events.register("post_run_cell", _end_of_cell)


def _end_of_cell(*_: object) -> None:
    repeated_lines.end()


def _keep_jupyters_loop_on_the_wall_clock() -> None:
    """The kernel's loop runs in the main thread, which is the program's while a call of the kit lasts."""
    try:
        loop = asyncio.get_running_loop()
    except RuntimeError:  # no kernel: IPython's terminal, or the grader's worker
        return
    loop.time = wall.monotonic  # type: ignore[method-assign]  # one loop's clock, not every loop's
