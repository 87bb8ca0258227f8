"""One program thread runs at a time: the baton says which.

A thread that the baton knows belongs to the program: its time is robot time, and it stops only in calls of
the kit (waits, sleeps, locks). When all known threads wait, the baton's holder lets the next event happen.
Threads that the baton does not know (Jupyter's own) run as ever, by the wall clock.
"""

import _thread
import itertools
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from course_lib.errors import CourseError
from course_lib.ros.clock import THREADS
from course_lib.ros.graph import Graph, current_graph
from course_lib.ros.program_thread import AtEnd, CtrlC, ProgramThread, Wait, always, never

POLLS_BEFORE_TIME_PASSES = 1_000  # calls without a wait, before looping on them lets time pass
POLLS_PER_STEP = 10
POLL_STEP_NS = 1_000_000  # [ns]


class DeadlockError(CourseError):
    """Every thread waits for another one, so nothing can happen any more."""


class Baton:
    """The right to run, which goes from thread to thread in an order that depends only on the program."""

    def __init__(self) -> None:
        self._threads: dict[int, ProgramThread] = {}  # by thread identifier
        self._polls_in_cells = 0  # a cell may loop over calls of the kit
        self._waiting: list[ProgramThread] = []
        self._holder: ProgramThread | None = None
        self._numbers = itertools.count(1)  # of threads, in the order of their making
        self._mutex = _thread.allocate_lock()
        self.stalled: Callable[[], object] = lambda: None  # called where the main thread must come in

    def governs(self, ident: int | None = None) -> bool:
        """Return whether a thread, by default the calling one, belongs to the program."""
        return (_thread.get_ident() if ident is None else ident) in self._threads

    def is_held_here(self) -> bool:
        """Return whether the calling thread belongs to the program and it is its turn."""
        me = self._threads.get(_thread.get_ident())
        return me is not None and self._holder is me

    def has_visitors(self, graph: Graph) -> bool:
        """Return whether ordinary threads wait for a run's robot time."""
        return any(thread.visits and thread.waits_in(graph) for thread in tuple(self._waiting))

    def known(self) -> "Known":
        """Turn the calling thread into a program thread for the length of a `with` block."""
        return Known(self)

    @contextmanager
    def unknown(self) -> Iterator[None]:
        """Run a `with` block of a program thread as an ordinary thread; it keeps the baton."""
        ident = _thread.get_ident()
        me = self._threads.pop(ident, None)
        try:
            yield
        finally:
            if me is not None:
                self._threads[ident] = me

    def new_thread(self, name: str, *, main: bool = False, visits: bool = False) -> ProgramThread:
        """Create a thread's place in the order of threads."""
        thread = ProgramThread(next(self._numbers), name=name, main=main, visits=visits)
        maker = self._threads.get(_thread.get_ident())
        if maker is not None and maker.at_end is not AtEnd.RETURN:
            thread.at_end = AtEnd.SHUT_DOWN
        return thread

    @contextmanager
    def at_end(self, at_end: AtEnd) -> Iterator[None]:
        """Set what the end of the run does to the calling program thread within a `with` block."""
        me = self._threads[_thread.get_ident()]
        before, me.at_end = me.at_end, at_end
        me.waits_after_end = me.sleeps_after_end = 0
        me.handlers = {}
        try:
            yield
        finally:
            me.at_end = before
            me.handlers = {}

    def handlers(self) -> dict[int, Any] | None:
        """Return the handlers of signals of the calling thread, if it is the main thread of a program."""
        me = self._threads.get(_thread.get_ident())
        return None if me is None or me.at_end is not AtEnd.INTERRUPT else me.handlers

    def is_shut_down(self) -> bool:
        """Return whether the run has ended and the calling thread is of a program."""
        me = self._threads.get(_thread.get_ident())
        return me is not None and me.at_end is not AtEnd.RETURN and current_graph().ended

    def line_up(self, thread: ProgramThread) -> None:
        """Queue a thread that has just been started for its first turn."""
        thread.wait = Wait(current_graph(), always, "its start")
        self._waiting.append(thread)

    def drop_out(self, thread: ProgramThread) -> None:
        """Forget a thread that lined up but could not be started."""
        self._stop_waiting(thread)

    def enter(self, me: ProgramThread) -> None:
        """Turn the calling thread into a program thread; returns when it has the baton."""
        with self._mutex:
            self._threads[_thread.get_ident()] = me
            if me.wait is None:
                self.line_up(me)
            self._give(None, me)
        self._await_turn(me)
        self._stop_waiting(me)

    def leave(self, me: ProgramThread) -> None:
        """End the calling thread's belonging to the program and hand the baton on."""
        with self._mutex:
            me.done = True
            del self._threads[_thread.get_ident()]
            if me.main:  # without the main thread time stands still
                heir = next((t for t in self._waiting if t.can_visit()), None)
            else:
                heir = self._runnable(me, current_graph()) or next((t for t in self._waiting if t.main), None)
            self._give(me, heir)

    def wait(
        self, ready: Callable[[], bool], *, until_ns: int | None, what: str, events_help: bool = True
    ) -> bool:
        """Block the calling program thread until `ready()` or `until_ns` [ns]; others go on meanwhile.

        `what` is named in a deadlock; `events_help` says whether events alone can end the wait. Returns what
        `ready` says in the end; raises a DeadlockError in the main thread if nothing can happen.
        """
        if ready():
            return True
        graph, me = current_graph(), self._threads[_thread.get_ident()]
        me.polls = 0
        wait = Wait(graph, ready, what, events_help=events_help)
        outer, me.wait = me.wait, wait
        alarm = None
        if until_ns is not None:
            wait.has_deadline = True
            alarm = graph.call_at(until_ns, wait.pass_deadline, node=THREADS, entity=me.index)
        try:
            if outer is None:  # else it is inside an event, while an outer wait lets events happen
                self._waiting.append(me)
            self._run_others(me, graph)
        finally:
            me.wait = outer
            if outer is None:
                self._stop_waiting(me)
            if alarm is not None:
                alarm.cancel()
        me.raise_pending()
        done = ready()
        if graph.ended and not done and not wait.deadline_passed:
            me.pass_end(sleeps=until_ns is not None)
        return done

    def sleep_until(self, wake_ns: int, what: str) -> None:
        """Block the calling program thread until robot time `wake_ns`, [ns]."""
        self.wait(never, until_ns=wake_ns, what=what)

    def poll(self) -> None:
        """Note a call that does not wait but that a program may loop on; looped on, it lets time pass."""
        me = self._threads.get(_thread.get_ident())
        if me is None:
            return
        me.polls += 1
        polls = me.polls
        if polls >= POLLS_BEFORE_TIME_PASSES and polls % POLLS_PER_STEP == 0:
            self.sleep_until(current_graph().now_ns + POLL_STEP_NS, "a loop that polls")
            me.polls = polls  # it is still the same loop

    def let_others_finish(self) -> None:
        """After the end of a run: let the other threads return from their waits and come to their ends."""
        graph, me = current_graph(), self._threads[_thread.get_ident()]
        while any(thread.waits_in(graph) for thread in self._waiting):
            me.waits_after_end = me.sleeps_after_end = 0
            self.wait(never, until_ns=None, what="the others' ends")

    def interrupt(self, thread: threading.Thread) -> None:
        """Raise KeyboardInterrupt in a thread of the program, as the end of a run does."""
        found = self._threads.get(thread.ident or 0)
        if found is not None and not current_graph().ended:
            found.raises = CtrlC()

    def _run_others(self, me: ProgramThread, graph: Graph) -> None:
        yielded = False
        while not me.can_run(graph) or (graph.ended and not yielded):
            other = self._runnable(me, graph)
            yielded = True
            if other is not None:
                self._hand_over(me, other)
            elif graph.ended:
                return
            elif not any(t.main for t in list(self._threads.values())):  # others may come in meanwhile
                self.stalled()
                self._hand_over(me, None)  # time moves only while the main thread is in a call of the kit
            elif not self._events_can_help(graph) or not (graph.advance() or graph.ended):
                self._name_deadlock(me, graph)

    def _runnable(self, me: ProgramThread, graph: Graph) -> ProgramThread | None:
        """Find the next thread, in the order after `me`, whose wait is over."""
        if len(self._waiting) == 1 and me in self._waiting:  # the usual case, at once
            return None
        able = [t for t in self._waiting if t is not me and t.can_run(graph)]
        return min(able, key=lambda thread: (thread.index <= me.index, thread.index), default=None)

    def _events_can_help(self, graph: Graph) -> bool:
        waits = [t.wait for t in self._waiting if t.wait is not None and t.wait.graph is graph]
        return any(wait.events_help or wait.has_deadline for wait in waits)

    def _name_deadlock(self, me: ProgramThread, graph: Graph) -> None:
        waits = ", ".join(
            f'thread "{t.name}" waits for {t.wait.what}'
            for t in self._waiting
            if t.wait is not None and t.wait.graph is graph
        )
        error = DeadlockError(
            f"Nothing can happen any more: {waits}. A wait must be ended by a timer, a message or another "
            "thread; give it a time limit, or let another thread spin."
        )
        next((t for t in self._waiting if t.main and t.waits_in(graph)), me).raises = error

    def _hand_over(self, me: ProgramThread, other: ProgramThread | None) -> None:
        """Hand the baton to `other`, or put it down until the main thread is back; block until it returns."""
        with self._mutex:
            self._give(me, other or self._runnable(me, current_graph()))
        self._await_turn(me)

    def _await_turn(self, me: ProgramThread) -> None:
        """Block until the baton is handed over; an interrupt is raised with the baton in hand."""
        waiting = True
        while waiting:
            try:
                me.turn.acquire()
                waiting = False
            except KeyboardInterrupt as interrupt:
                again = isinstance(me.raises, KeyboardInterrupt)
                me.raises = interrupt
                with self._mutex:
                    if again:  # a second one: whoever has the baton is stuck outside the kit
                        self._holder = me
                    waiting = self._holder is not me
                    if not waiting:
                        me.turn.acquire(False)  # unless the interrupt came just after it was taken

    def _give(self, giver: ProgramThread | None, heir: ProgramThread | None) -> None:
        """Hand the baton on under the mutex, unless an impatient interrupt took it from the giver."""
        if self._holder is giver:
            self._holder = heir
            if heir is not None:
                heir.turn.release()

    def _stop_waiting(self, me: ProgramThread) -> None:
        if me in self._waiting:
            self._waiting.remove(me)
        me.wait = None


class Known:
    """The `with` block of `Baton.known`: a generator takes twice as long, and each callback needs two."""

    __slots__ = ("_baton", "_me")

    def __init__(self, baton: Baton) -> None:
        self._baton = baton

    def __enter__(self) -> None:
        baton = self._baton
        me = baton._threads.get(_thread.get_ident())
        if me is not None:
            me.depth += 1
        else:
            thread = threading.current_thread()
            main = thread is threading.main_thread()
            me = baton.new_thread(thread.name, main=main, visits=not main)
            me.polls = baton._polls_in_cells if me.main and current_graph().notebook else 0
            baton.enter(me)
        self._me = me
        try:
            me.raise_pending()
        except BaseException:
            self.__exit__()
            raise

    def __exit__(self, *_: object) -> None:
        me, baton = self._me, self._baton
        me.depth -= 1
        if me.depth == 0:
            baton._polls_in_cells = me.polls if me.main else baton._polls_in_cells
            baton.leave(me)


baton = Baton()
