"""How fast robot time goes: as the wall clock while somebody is watching, else at full speed."""

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Literal

from course_lib.errors import CourseError
from course_lib.ros import wall
from course_lib.ros.graph import Graph

WAIT_FOR_PAGE = 2.0  # [s] of the wall clock
SLICE = 0.02  # [s] an interrupt is noticed within

pages: set[Callable[[], bool]] = set()  # each viewer in a cell adds: is its page there? Waited for once


def wanted() -> Literal["real", "fast"]:
    """Say which pace this process is to keep.

    Kernels that a Jupyter server started are watched; nbclient, nbmake and scripts are not. `COURSE_PACE`
    overrides.

    Raises:
        CourseError: If COURSE_PACE is neither real nor fast.
    """
    said = os.environ.get("COURSE_PACE")
    if said == "real" or (said is None and "JPY_SESSION_NAME" in os.environ):
        return "real"
    if said in (None, "fast"):
        return "fast"
    raise CourseError(f"COURSE_PACE is {said!r}; write COURSE_PACE=real or COURSE_PACE=fast.")


@contextmanager
def kept(graph: Graph) -> Iterator[None]:
    """Keep the wanted pace in a call that waits; first give the page time to show its viewer."""
    if not graph.notebook or wanted() == "fast" or graph.pace is not None:
        yield
        return
    _wait_for_pages()
    graph.pace = WallPace(graph)
    try:
        yield
    finally:
        graph.pace = None


class WallPace:
    """Holds robot time back to the wall clock, from now on."""

    def __init__(self, graph: Graph) -> None:
        self._robot_ns = graph.now_ns
        self._wall = wall.monotonic()

    def __call__(self, due_ns: int) -> bool:
        """Say whether the wall clock has come to robot time `due_ns`, [ns]; wait for it a little if not."""
        left = (due_ns - self._robot_ns) * 1e-9 - (wall.monotonic() - self._wall)
        if left > 0:
            wall.sleep(min(left, SLICE))
        return left <= 0


def _wait_for_pages() -> None:
    deadline = wall.monotonic() + WAIT_FOR_PAGE
    while not all(is_there() for is_there in tuple(pages)) and wall.monotonic() < deadline:
        wall.sleep(SLICE)
    pages.clear()
