"""A thread that belongs to the program, what it waits for, and what ends it."""

import _thread
from collections.abc import Callable

from course_lib.ros.graph import Graph


class StoppedProgram(KeyboardInterrupt):
    """Ends a program's main thread that goes on waiting after the end of the run."""


class StoppedThread(SystemExit):
    """Ends another such thread, without a word."""


def always() -> bool:
    """Say that there is nothing to wait for."""
    return True


class ProgramThread:
    """Where a thread of the program stands in their order, and whether it can go on."""

    def __init__(self, index: int, *, name: str, main: bool) -> None:
        self.index = index
        self.name = name
        self.main = main
        self.turn = _thread.allocate_lock()  # held; released by whoever hands over the baton
        self.turn.acquire()
        self.graph: Graph | None = None  # the run it waits in; None while it is running
        self.ready: Callable[[], bool] = always
        self.has_deadline = False
        self.deadline_passed = False
        self.what = ""
        self.events_help = True
        self.depth = 1
        self.polls = 0
        self.waits_after_end = 0
        self.raises: BaseException | None = None
        self.done = False

    def can_run(self, graph: Graph) -> bool:
        """Say whether its wait is over."""
        if self.graph is not graph:
            return False
        return self.deadline_passed or graph.ended or self.raises is not None or self.ready()

    def pass_deadline(self) -> None:
        """Note that its deadline has come: the event that ends its wait."""
        self.deadline_passed = True
