"""The pace of robot time: real time while someone is watching, otherwise full speed."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Literal

from course_lib.errors import CourseError
from course_lib.ros.graph.graph import Graph
from course_lib.ros.time import wall

# Robot time after which a call stops that would otherwise run until it is interrupted [s].
SECONDS_WITHOUT_A_PAGE = 5.0
# Wall time to wait for viewer pages [s].
WAIT_FOR_PAGE = 2.0
# Length of one sleep, so that an interrupt is noticed soon [s].
SLICE = 0.02

# Each viewer adds a function that returns whether its page is connected. They are waited for once.
pages: set[Callable[[], bool]] = set()
# The same functions, for as long as their viewers exist.
views: set[Callable[[], bool]] = set()


def mode() -> Literal["real", "fast"]:
    """Return the pace of this process. `COURSE_PACE` overrides it.

    Kernels started by a Jupyter server are assumed to be watched; nbclient, nbmake and scripts are
    not.
    """
    value = os.environ.get("COURSE_PACE")
    if value == "real" or (value is None and "JPY_SESSION_NAME" in os.environ):
        return "real"
    if value in (None, "fast"):
        return "fast"
    raise CourseError(f"COURSE_PACE is {value!r}; write COURSE_PACE=real or COURSE_PACE=fast.")


@dataclass(eq=False, repr=False)
class Speed:
    """The speed of robot time relative to the wall clock.

    The Time panel sets it from any thread.
    """

    rate: float = 1.0
    is_paused: bool = False
    # Robot time that is to pass even while paused [ns].
    step_ns: int = 0

    def advance_ns(self, seconds: float) -> int:
        """Return the robot time [ns] that passes in `seconds` [s] of wall time."""
        step_ns, self.step_ns = self.step_ns, 0
        return step_ns + (0 if self.is_paused else round(seconds * self.rate * 1e9))


def speed_of(graph: Graph) -> Speed:
    """Return the speed of a graph's robot time. It applies in real time only."""
    return graph.state(Speed)


@contextmanager
def keep_pace(graph: Graph) -> Iterator[None]:
    """Keep the selected pace during a waiting call. First give viewer pages time to connect."""
    if not graph.notebook or mode() == "fast" or graph.pace is not None or graph.keeps_wall_time:
        yield
        return
    if speed_of(graph).is_paused:
        sys.stdout.write("Robot time is paused. Press ▶ in the viewer's Time panel to continue.\n")
    deadline = wall.monotonic() + WAIT_FOR_PAGE
    while not all(is_there() for is_there in tuple(pages)) and wall.monotonic() < deadline:
        wall.sleep(SLICE)
    pages.clear()
    graph.pace = WallPace(graph)
    try:
        yield
    finally:
        graph.pace = None


class WallPace:
    """Keeps a graph's time in step with the wall clock, at the graph's speed.

    The graph calls it before each event.
    """

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._speed = speed_of(graph)
        # Robot time that the wall clock has reached.
        self._allowed_ns = graph.now_ns
        self._wall_time = wall.monotonic()

    def reached_ns(self, limit: float) -> int:
        """Return the robot time [ns] of the wall clock, at most `limit` [s] after the last event.

        On a machine that is too slow for its nodes, robot time falls behind and stays behind. To
        catch up would keep the kernel busy, and the clock would be further ahead at the next call.
        """
        previous, self._wall_time = self._wall_time, wall.monotonic()
        passed_ns = self._speed.advance_ns(min(self._wall_time - previous, limit))
        now_ns, most_ns = self._graph.now_ns, round(limit * self._speed.rate * 1e9)
        reached_ns = max(self._allowed_ns, now_ns) + passed_ns
        self._allowed_ns = min(reached_ns, now_ns + max(passed_ns, most_ns))
        return self._allowed_ns

    def __call__(self, due_ns: int) -> bool:
        """Return whether the wall clock has reached robot time `due_ns` [ns].

        If not, wait briefly.
        """
        previous, self._wall_time = self._wall_time, wall.monotonic()
        self._allowed_ns += self._speed.advance_ns(self._wall_time - previous)
        remaining_seconds = (due_ns - self._allowed_ns) * 1e-9 / self._speed.rate
        if remaining_seconds > 0:
            wall.sleep(min(remaining_seconds, SLICE))
        return remaining_seconds <= 0
