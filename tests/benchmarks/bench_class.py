"""Students on one machine: `python -m tests.benchmarks.bench_class`, 1, 10 and 50 kernels for 60 s each.

Memory is PSS, in which a page of memory that n processes share counts 1/n in each. All kernels run
week 7's dashboard, and each has a page that follows its view.
"""

import argparse
import datetime
import os
import platform
import shutil
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import psutil

from course_lib.arrays import Matrix
from course_lib.course.exercise import read_notebook, source
from course_lib.course.material import lessons_dir
from tests.benchmarks.students import Student, follow, hide, run_cells, students

CLASS = 1000  # students that the last line is about
SETUP = ("load", "more-imports")  # cells of the lesson that are run in addition to the exported ones
SHOW = """
rclpy.init()
viewer = Viewer(fixed_frame="world")
viewer["Grid"]["Plane Cell Count"] = 20
viewer.add("TF", show_names=True, marker_scale=2.0)
viewer.add("Image", "/perception/image", name="Camera")
viewer.add("MarkerArray", "/perception/markers", name="Detections")
wide = {"line_style": "Billboards", "line_width": 0.12}
viewer.add("Path", "/planned_path", name="Plan", color="25; 255; 0", **wide)
viewer.add("Path", "/robot_trajectory", name="Trajectory", color="255; 160; 0", **wide)
viewer.view = Orbit(distance=16.0, yaw=-0.6, pitch=0.7)
live = run_live(TfPublisher(), camera(), detector(), Overlay(), PerceptionNode(), PathPublisher())
viewer"""  # of the cells "start", "overlay-run", "perception-run" and "paths-run"
PEER = """
import numpy as np, pinocchio, meshcat
import meshcat.geometry as g
import meshcat.transformations as tf
viewer = meshcat.Visualizer()
viewer["box"].set_object(g.Box([1, 1, 1]))
viewer["box"].set_transform(tf.translation_matrix([1, 0, 0]))"""


def dashboard() -> list[str]:
    """Return the cells that run the dashboard: the lesson's own classes, all nodes and displays."""
    cells = read_notebook(lessons_dir() / "week07_dashboard.ipynb")["cells"]
    texts = [source(c) for c in cells if c["id"] in SETUP or source(c).startswith("# export\n")]
    return [*texts, SHOW]


@dataclass(frozen=True)
class Row:
    """A row of the table: the resources that a number of kernels use."""

    name: str
    count: int
    start: float  # [s] until a kernel has run its cells
    memory: float  # [MB] per student, shared pages counted once
    cpu: float  # [%] of a core per student
    frames: float  # [1/s] that the median page sees
    worst: float  # [1/s] that the slowest page sees
    rate: float  # [kB/s] that a page receives

    def __str__(self) -> str:
        numbers = f"{self.start:10.1f}{self.memory:10.1f}{self.cpu:9.1f}{self.frames:10.1f}{self.worst:9.1f}"
        return f"{self.name:34}{self.count:8}{numbers}{self.rate:8.0f}"


HEAD = (
    f"{'each student':34}{'kernels':>8}{'start [s]':>10}{'PSS [MB]':>10}{'CPU [%]':>9}"
    f"{'frames/s':>10}{'slowest':>9}{'kB/s':>8}"
)


def pss(process: psutil.Process) -> float:
    """Return the memory of a process in [MB], pages that n processes share counted as 1/n."""
    lines = Path(f"/proc/{process.pid}/smaps_rollup").read_text("ascii").splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("Pss:")) / 1024


def cpu(student: Student) -> float:
    """Return the processor time of a student so far, [s]."""
    return sum(sum(process.cpu_times()[:2]) for process in student.processes())


@dataclass(frozen=True)
class Case:
    """A workload of the kernels: its name and cells."""

    name: str
    cells: list[str]
    hidden: bool = False  # the pages are behind other tabs
    kit: Path | None = None  # a checkout; None for the installed kit


def measured(case: Case, count: int, seconds: float) -> Row:
    """Run a case in `count` kernels, then measure its resource use for some time [s]."""
    lessons = case.kit / "notebooks" if case.kit else lessons_dir()
    with TemporaryDirectory() as holder:
        folder = Path(shutil.copytree(lessons, Path(holder, "lessons")))
        with students(count, folder, case.kit) as pupils:
            begun = time.monotonic()
            run_cells(pupils, case.cells[:-1])
            run_cells(pupils, case.cells[-1:])  # the dashboards begin together
            start = (time.monotonic() - begun) / count
            if case.hidden:
                hide(pupils)
            before, begun = readings(pupils), time.monotonic()
            follow(pupils, seconds)
            took = time.monotonic() - begun
            memory = sum(pss(process) for s in pupils for process in s.processes()) / count
            spent, frames, received = (readings(pupils) - before).T / took
            used = 100 * spent.mean(), float(np.median(frames)), frames.min(), received.mean() / 1000
    return Row(case.name, count, start, memory, *used)


def readings(pupils: list[Student]) -> Matrix:
    """Return each student's CPU time [s], frames and received bytes so far, shape (N, 3)."""
    return np.array([(cpu(student), student.frames, student.received) for student in pupils])


def machine() -> str:
    """Return the machine, the time and the load under which this runs."""
    lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    model = next((line.partition(": ")[2] for line in lines if "model name" in line), platform.machine())
    memory = psutil.virtual_memory()
    sizes = f"{memory.total / 2**30:.0f} GB ({memory.available / 2**30:.0f} free)"
    load, python = os.getloadavg()[0], platform.python_version()
    return f"{datetime.date.today()}, {os.cpu_count()} x {model}, {sizes}, load {load:.1f}, Python {python}"


def cases(peer: bool, before: Path | None) -> Iterator[Case]:
    """Yield the requested cases."""
    cells = dashboard()
    yield Case("week 7's dashboard", cells)
    yield Case("the same, pages hidden", cells, hidden=True)
    if before:
        yield Case("week 7's dashboard, before", cells, kit=before)
        yield Case("the same, pages hidden, before", cells, hidden=True, kit=before)
    if peer:
        yield Case("numpy, pin and meshcat at rest", [PEER])
        yield Case("ipykernel and numpy at rest", ["import numpy"])


def thousand(row: Row) -> str:
    """Return the resources that a thousand simultaneous students need."""
    gigabytes, cores = CLASS * row.memory / 1024, CLASS * row.cpu / 100
    return f"{CLASS} students: {gigabytes:.0f} GB and {cores:.0f} cores, beside their Jupyter servers"


def main() -> None:
    """Print a row per case and number of kernels, and the resources for a thousand students."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--kernels", type=int, nargs="+", default=[1, 10, 50])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--only", default="", help="part of a row's name")
    parser.add_argument("--peer", action="store_true", help="measure kernels without the kit beside")
    parser.add_argument("--before", type=Path, help="a checkout of an earlier commit, measured beside")
    options = parser.parse_args()
    print(machine(), HEAD, sep="\n")
    for case in cases(options.peer, options.before):
        for count in options.kernels if options.only in case.name else ():
            row = measured(case, count, options.seconds)
            print(row, flush=True)
            if case.name == "week 7's dashboard" and row.cpu * count < 50 * (os.cpu_count() or 1):
                print(thousand(row), flush=True)


if __name__ == "__main__":
    main()
