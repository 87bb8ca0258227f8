"""A thread that belongs to the program, what it waits for, and what ends it."""

import _thread
import signal
import sys
from collections.abc import Callable
from enum import Enum, auto
from typing import Any

from course_lib.ros.graph import Graph

WAITS_AFTER_THE_END = 200  # that return at once, before the thread is ended
SLEEPS_AFTER_THE_END = 100  # of them, those with a time limit: robot time stands still


class AtEnd(Enum):
    """The effect of the end of a run on a waiting thread."""

    RETURN = auto()  # it returns: a cell, a test, a tool
    INTERRUPT = auto()  # it raises KeyboardInterrupt, once: a program's main thread
    SHUT_DOWN = auto()  # it returns, once if it has a time limit: a program's other threads
    STOP = auto()  # it ends the thread: callbacks in threads of their own


class ShutDown(Exception):  # noqa: N818 - the base of ROS's exceptions, which are no errors
    """Raised by a call that a shutdown ended; at the end of a run it ends a program in silence."""


class CtrlC(KeyboardInterrupt):
    """Stands for Ctrl+C on its way to a program in a thread, which may have a handler of its own."""


class StoppedProgram(KeyboardInterrupt):
    """Ends a program's main thread that goes on waiting after the end of the run."""


class StoppedThread(SystemExit):
    """Ends another such thread, without a word."""


def always() -> bool:
    """Return True: there is nothing to wait for."""
    return True


def never() -> bool:
    """Return False: the condition of a wait that only its deadline ends."""
    return False


class Wait:
    """One wait of a program thread: what ends it, and what a deadlock message calls it."""

    __slots__ = ("deadline_passed", "events_help", "graph", "has_deadline", "ready", "what")

    def __init__(
        self, graph: Graph, ready: Callable[[], bool], what: str, *, events_help: bool = True
    ) -> None:
        self.graph = graph
        self.ready = ready
        self.what = what
        self.events_help = events_help
        self.has_deadline = False
        self.deadline_passed = False

    def pass_deadline(self) -> None:
        """Note that the deadline has come: the event that ends the wait."""
        self.deadline_passed = True


class ProgramThread:
    """The place of one thread in the order of threads, and its wait.

    Args:
        index: Its place in the order.
        name: What a deadlock message calls it.
        main: It is Python's main thread.
        visits: An ordinary thread that belongs to the program for the time of one `with baton.known()`.
    """

    def __init__(self, index: int, *, name: str, main: bool, visits: bool = False) -> None:
        self.index = index
        self.name = name
        self.main = main
        self.visits = visits
        self.turn = _thread.allocate_lock()  # held; released by the thread that hands over the baton
        self.turn.acquire()
        self.wait: Wait | None = None  # the innermost one; None while it is running
        self.depth = 1
        self.polls = 0
        self.at_end = AtEnd.RETURN
        self.handlers: dict[int, Any] = {}  # of signals, which its program has set
        self.waits_after_end = 0
        self.sleeps_after_end = 0
        self.stopped = False
        self.raises: BaseException | None = None
        self.done = False

    def pass_end(self, *, sleeps: bool) -> None:
        """Do what a wait that the end of the run cut short does; `sleeps`: it has a time limit."""
        self.waits_after_end += 1
        self.sleeps_after_end += sleeps
        if self.at_end is AtEnd.INTERRUPT and self.waits_after_end == 1:
            self.interrupt()
            return
        sleeps_left = 1 if self.at_end is AtEnd.SHUT_DOWN else SLEEPS_AFTER_THE_END
        if self.at_end is AtEnd.STOP or self.sleeps_after_end > sleeps_left:
            self._stop()
        if self.waits_after_end > WAITS_AFTER_THE_END:
            self._stop()

    def interrupt(self) -> None:
        """Do what Ctrl+C does: call the program's handler; without one it raises KeyboardInterrupt."""
        handler = self.handlers.get(signal.SIGINT, signal.SIG_DFL)
        if callable(handler):
            handler(signal.SIGINT, sys._getframe(1))
        elif handler is not signal.SIG_IGN:
            raise KeyboardInterrupt

    def _stop(self) -> None:
        """End the thread; a main thread that catches the interrupt is ended by the next one."""
        interrupts = (self.main or self.at_end is AtEnd.INTERRUPT) and not self.stopped
        self.stopped = True
        raise StoppedProgram if interrupts else StoppedThread

    def raise_pending(self) -> None:
        """Raise what another thread, or an interrupt, left for this one."""
        if self.raises is not None:
            error, self.raises = self.raises, None
            if not isinstance(error, CtrlC):
                raise error
            self.interrupt()

    def waits_in(self, graph: Graph) -> bool:
        """Return whether it waits in a run."""
        wait = self.wait
        return wait is not None and wait.graph is graph

    def can_run(self, graph: Graph) -> bool:
        """Return whether it waits in a run, and its wait is over."""
        wait = self.wait
        if wait is None or wait.graph is not graph:
            return False
        return wait.deadline_passed or graph.ended or self.raises is not None or wait.ready()

    def can_visit(self) -> bool:
        """Return whether it is a visitor whose wait is over, in whichever run."""
        return self.visits and self.wait is not None and self.can_run(self.wait.graph)
