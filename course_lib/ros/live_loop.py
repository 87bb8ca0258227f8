"""The task of a kernel that moves robot time along with the wall clock between the cells."""

import asyncio
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from course_lib.ros.busy import Callback, watch
from course_lib.ros.driving import executor_with, spin_until
from course_lib.ros.graph import Graph
from course_lib.ros.interrupts import live_interrupts
from course_lib.ros.live_run import LiveRun, runs_of
from course_lib.ros.own_line import line_of_traceback
from course_lib.ros.pace import WallPace

STEP = 0.02  # [s] of the wall clock
CATCH_UP = 0.25  # [s] at most, after a cell that kept the kernel busy


class LiveLoop:
    """Drives a graph's live runs, as long as there are any."""

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._runs = runs_of(graph)
        self._paced = WallPace(graph)

    async def run(self) -> None:
        """Go on step by step; a callback's exception, or ■, stops all that runs."""
        try:
            while self._runs:
                await asyncio.sleep(STEP)
                self._stop_what_is_over()
                if self._runs:
                    self._step()
                for run in tuple(self._runs):
                    run.show_state()
        finally:
            live_interrupts.give_back()

    def _stop_what_is_over(self) -> None:
        for run in tuple(self._runs):
            if run.is_over():
                run.stop()

    def _step(self) -> None:
        runs = tuple(self._runs)
        try:
            with live_interrupts.heard(), self._kept(), executor_with(()) as executor:
                spin_until(executor, self._paced.come_to(CATCH_UP))
        except KeyboardInterrupt as interrupt:
            self._interrupted(runs, line_of_traceback(interrupt.__traceback__))
        except Exception:
            show_error()
            for run in runs:
                run.stop()
        if live_interrupts.asked:
            self._interrupted(runs, "")

    def _interrupted(self, runs: tuple[LiveRun, ...], line: str) -> None:
        """Stop what Stop was clicked for; all if it was ■."""
        asked, live_interrupts.asked = live_interrupts.asked, False
        for run in runs:
            if asked or run.stop_clicked:
                run.note = f"interrupted in {line}" if line else ""
                run.stop()
                run.show_state()

    @contextmanager
    def _kept(self) -> Iterator[None]:
        """Hold robot time back to the wall clock also where a callback sleeps; name what takes long."""
        former, watch.tell = watch.tell, self._tell
        self._graph.pace = self._paced
        try:
            yield
        finally:
            self._graph.pace = None
            watch.tell = former

    def _tell(self, callback: Callback, line: str) -> None:
        its_own = [run for run in self._runs if run.has_node(callback.node)]
        for run in its_own or tuple(self._runs):
            run.show_state(f"busy for {callback.seconds:.0f} s in {line}")


def show_error() -> None:
    """Show a callback's exception under the cell that started the run."""
    from IPython import get_ipython

    get_ipython().CustomTB(*sys.exc_info(), tb_offset=0)  # what loading the extension has set
