"""`%ros2 …` in a notebook."""

import shlex
import sys
from typing import TYPE_CHECKING

from course_lib.errors import CourseError
from course_lib.ros.graph import current_graph
from course_lib.tools.ros2 import ros2
from course_lib.tools.sources import GraphSource

if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell


def register(shell: "InteractiveShell") -> None:
    """Give a shell the magics; again changes nothing."""
    shell.register_magic_function(ros2_magic, "line", "ros2")  # type: ignore[arg-type]  # wrongly typed there


def ros2_magic(line: str) -> None:
    """Run a `ros2` command on this notebook's nodes, like %ros2 topic list."""
    from IPython.core.error import UsageError

    try:
        ros2(shlex.split(line), GraphSource(current_graph()), sys.stdout.write)
    except (CourseError, ValueError) as error:  # ValueError: shlex on an open quotation mark
        raise UsageError(str(error)) from None
