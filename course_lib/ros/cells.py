"""A kernel's cell between its calls of the kit: its sleeps, and what they drive."""

import threading
from collections.abc import Callable

from course_lib.ros import wall


class RunningCell:
    """The cell that runs, if one does; what drives nodes meanwhile is set by `%load_ext course_lib`."""

    def __init__(self) -> None:
        self.runs = False
        self.drive: Callable[[float], bool] = lambda seconds: False

    def runs_here(self) -> bool:
        """Return whether the calling thread runs a cell."""
        return self.runs and threading.current_thread() is threading.main_thread()

    def rest(self, seconds: float) -> None:
        """Sleep, [s]; where live nodes or threads of cells wait for robot time, it passes."""
        if not (self.runs_here() and self.drive(seconds)):
            wall.sleep(seconds)


cell = RunningCell()
