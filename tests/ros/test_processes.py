"""Programs in separate threads."""

import contextvars

from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.ros.programs.process import FunctionProcess, Processes
from course_lib.ros.time import virtual_time
from course_lib.ros.time.time_lock import time_lock

CELL = contextvars.ContextVar("CELL", default="none")


def test_program_output_belongs_to_the_cell_that_started_the_program() -> None:
    """ipykernel keeps the cell in a context variable; messages of pages change its global fallback."""
    observed: list[str] = []
    virtual_time.install()
    with use_graph(Graph()), time_lock.hold():
        token = CELL.set("the cell that launches")
        processes = Processes()
        processes.start(FunctionProcess("rviz2", lambda: observed.append(CELL.get()), []))
        CELL.reset(token)
        processes.wait()
    assert observed == ["the cell that launches"]
