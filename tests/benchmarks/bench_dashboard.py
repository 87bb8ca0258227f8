"""Time of week 7's dashboard: `python tests/benchmarks/bench_dashboard.py`, five robot-seconds.

The lesson's own nodes run, with a camera of 160 x 120 pixels at 5 Hz; DESIGN's budget is 1.5 s.
"""

import statistics
import sys
import time
from types import ModuleType
from typing import Any

from course_lib.ros.programs.import_path import install

install()

import rclpy  # noqa: E402  # needs the stand-in's packages

from course_lib import spin_for  # noqa: E402  # as above
from course_lib.course.exercise import read_notebook, source  # noqa: E402  # as above
from course_lib.course.material import lessons_dir  # noqa: E402  # as above
from course_lib.sensors.sensor_nodes import Pinhole  # noqa: E402  # as above

RUNS = 5
SECONDS = 5.0  # [s] of robot time
LENS = "Pinhole(240, 180, 200.0)"  # the lesson's
CELLS = ("more-imports",)  # in addition to the exported cells
NODES = ("TfPublisher", "camera", "detector", "Overlay", "PerceptionNode", "PathPublisher")


def lesson() -> dict[str, Any]:
    """Run the cells of the lesson that define nodes and the world."""
    names, parts = dict[str, Any](), ModuleType("week07_parts")
    code = (lessons_dir() / "week07_parts.py").read_text("utf-8")
    exec(code.replace(LENS, "Pinhole(160, 120, 133.0)"), parts.__dict__)
    sys.modules["week07_parts"] = parts
    for cell in read_notebook(lessons_dir() / "week07_dashboard.ipynb")["cells"]:
        text = source(cell)
        if text.startswith("# export\n") or cell["id"] in CELLS:
            exec(text, names)
    assert names["camera"].__globals__["Pinhole"] is Pinhole
    return names


def main() -> None:
    """Print the median time of a run, by the wall clock and of the processor, [s]."""
    names, walls, processor = lesson(), list[float](), list[float]()
    rclpy.init()
    for _ in range(RUNS):
        nodes = [names[name]() for name in NODES]
        spin_for(0.5, *nodes)
        wall, cpu = time.perf_counter_ns(), time.process_time()
        spin_for(SECONDS, *nodes)
        processor.append(time.process_time() - cpu)
        walls.append((time.perf_counter_ns() - wall) / 1e9)
        for node in nodes:
            node.destroy_node()
    for name, times in (("wall", walls), ("processor", processor)):
        print(f"five robot-seconds of the dashboard, {name}: {statistics.median(times):.2f} s (budget 1.5)")


if __name__ == "__main__":
    main()
