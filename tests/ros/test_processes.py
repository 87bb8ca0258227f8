"""Programs in threads of their own."""

import contextvars

from course_lib.ros import virtual_time
from course_lib.ros.baton import baton
from course_lib.ros.graph import Graph, use_graph
from course_lib.ros.process import Function, Processes

CELL = contextvars.ContextVar("CELL", default="none")


def test_what_a_program_displays_belongs_to_the_cell_that_started_it() -> None:
    """ipykernel keeps the cell in a context variable; messages of pages change its global fallback."""
    seen: list[str] = []
    virtual_time.install()
    with use_graph(Graph()), baton.known():
        token = CELL.set("the cell that launches")
        processes = Processes()
        processes.start(Function("rviz2", lambda: seen.append(CELL.get()), []))
        CELL.reset(token)
        processes.wait()
    assert seen == ["the cell that launches"]
