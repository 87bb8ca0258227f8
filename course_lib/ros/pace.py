"""The pace of robot time: the wall clock's while somebody is watching, else full speed."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Literal

from course_lib.errors import CourseError
from course_lib.ros import wall
from course_lib.ros.graph import Graph

SECONDS_WITHOUT_A_PAGE = 5.0  # [s] of robot time, where a watched call would go on until it is stopped
WAIT_FOR_PAGE = 2.0  # [s] of the wall clock
SLICE = 0.02  # [s] an interrupt is noticed within

pages: set[Callable[[], bool]] = set()  # each viewer in a cell adds: is its page there? Waited for once
views: set[Callable[[], bool]] = set()  # the same, as long as the viewer lives


def wanted() -> Literal["real", "fast"]:
    """Return the pace that this process is to keep; `COURSE_PACE` overrides it.

    Kernels that a Jupyter server started are watched; nbclient, nbmake and scripts are not.
    """
    said = os.environ.get("COURSE_PACE")
    if said == "real" or (said is None and "JPY_SESSION_NAME" in os.environ):
        return "real"
    if said in (None, "fast"):
        return "fast"
    raise CourseError(f"COURSE_PACE is {said!r}; write COURSE_PACE=real or COURSE_PACE=fast.")


class Speed:
    """The speed of robot time against the wall clock, as the Time panel sets it, from any thread."""

    def __init__(self) -> None:
        self.rate = 1.0
        self.paused = False
        self.step_ns = 0  # robot time that shall go by although it is paused, [ns]

    def passed_ns(self, seconds: float) -> int:
        """Return the robot time, [ns], that goes by in so much wall time, [s]."""
        step_ns, self.step_ns = self.step_ns, 0
        return step_ns + (0 if self.paused else round(seconds * self.rate * 1e9))


def speed_of(graph: Graph) -> Speed:
    """Return the speed of a graph's robot time, where the wall clock is kept to at all."""
    return graph.part(Speed)


@contextmanager
def kept(graph: Graph) -> Iterator[None]:
    """Keep the wanted pace in a call that waits; first give the page time to show its viewer."""
    if not graph.notebook or wanted() == "fast" or graph.pace is not None or graph.keeps_wall_time:
        yield
        return
    if speed_of(graph).paused:
        sys.stdout.write("Robot time is paused: ▶ in the viewer's Time panel lets it go on.\n")
    _wait_for_pages()
    graph.pace = WallPace(graph)
    try:
        yield
    finally:
        graph.pace = None


class WallPace:
    """The pace of the wall clock, from now on, at the graph's speed: a graph asks it before each event."""

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._speed = speed_of(graph)
        self._allowed_ns = graph.now_ns  # robot time that the wall clock has come to
        self._wall = wall.monotonic()

    def come_to(self, limit: float) -> int:
        """Return the robot time that the wall clock has come to, [ns], at most `limit` [s] more."""
        before, self._wall = self._wall, wall.monotonic()
        passed_ns = self._speed.passed_ns(min(self._wall - before, limit))
        self._allowed_ns = max(self._allowed_ns, self._graph.now_ns) + passed_ns
        return self._allowed_ns

    def __call__(self, due_ns: int) -> bool:
        """Return whether the wall clock has come to robot time `due_ns`, [ns]; wait a little if not."""
        before, self._wall = self._wall, wall.monotonic()
        self._allowed_ns += self._speed.passed_ns(self._wall - before)
        left = (due_ns - self._allowed_ns) * 1e-9 / self._speed.rate
        if left > 0:
            wall.sleep(min(left, SLICE))
        return left <= 0


def _wait_for_pages() -> None:
    deadline = wall.monotonic() + WAIT_FOR_PAGE
    while not all(is_there() for is_there in tuple(pages)) and wall.monotonic() < deadline:
        wall.sleep(SLICE)
    pages.clear()
