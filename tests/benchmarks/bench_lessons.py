"""Frames of each lesson's live views in JupyterLab: `python -m tests.benchmarks.bench_lessons`.

The cells of a lesson run one by one. While the nodes of a cell run live, its view is turned, as by a hand on
the arrow keys, so that each frame of the page draws a new picture. Software draws, as in the tests.
"""

import argparse
import json
import os
import statistics
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psutil
from playwright.sync_api import Locator, Page
from playwright.sync_api import TimeoutError as NotShown

from course_lib.course.state import lessons
from course_lib.viewer.picture import find_browser
from tests.benchmarks.bench_viewer import COUNT_PICTURES
from tests.browser.fake_host import chromium
from tests.browser.jupyterlab import Lab, Notebook, course_lab, view_of

WARM = 1.5  # rotation time before counting starts [s], in which the level of detail is selected
SECONDS = 4.0  # [s] that frames are counted for
RUNNING = """
from course_lib.ros.graph.graph import current_graph
from course_lib.ros.time.driving import live_runs
print(len(live_runs(current_graph())))"""
TURN = """canvas => {
    const turn = () => {
        if (!canvas.isConnected || canvas.rests) return;
        canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowLeft" }));
        requestAnimationFrame(turn);
    };
    canvas.rests = false;
    requestAnimationFrame(turn);
}"""


@dataclass(frozen=True, slots=True)
class Frames:
    """Counters of one live view.

    Args:
        lesson: The lesson's name.
        cell: Index of the cell.
        turned: Pictures per second while the view is turned.
        still: Pictures per second while only the nodes change it, as a robot that moves alone.
        browser: CPU of the browser while the view is turned, in cores.
        kernel: CPU of the kernel while the view is turned, in cores.
        browser_still: CPU of the browser while only the nodes change the view, in cores.
        kernel_still: CPU of the kernel at the same time, in cores.
        load: The machine's load in the last minute.
    """

    lesson: str
    cell: int
    turned: float
    still: float
    browser: float
    kernel: float
    browser_still: float
    kernel_still: float
    load: float


def main() -> None:
    """Print a line per live view, and the slowest view of each lesson."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="week", help="part of a lesson's name")
    parser.add_argument("--cells", type=int, nargs="*", help="indices of the cells whose views are measured")
    parser.add_argument(
        "--profile", type=Path, help="write a CPU profile of the page per view into this folder"
    )
    options = parser.parse_args()
    counted = []
    for row in measured(options.only, options.cells, options.profile):
        counted.append(row)
        print(
            f"| {row.lesson} | {row.cell} | {row.turned:.1f} | {row.browser:.2f} | {row.kernel:.2f} "
            f"| {row.still:.1f} | {row.browser_still:.2f} | {row.kernel_still:.2f} | {row.load:.1f} |",
            flush=True,
        )
    for lesson in sorted({row.lesson for row in counted}):
        rows = [row.turned for row in counted if row.lesson == lesson]
        print(f"{lesson}: slowest {min(rows):.1f}, median {statistics.median(rows):.1f} of {len(rows)}")


@contextmanager
def opened_lab() -> Iterator[Lab]:
    """Run JupyterLab and a browser for lessons."""
    with tempfile.TemporaryDirectory() as folder, chromium() as browser:
        top = Path(folder)
        with course_lab(top / "students", top / "home") as address:
            yield Lab(browser, top / "students", address)


def measured(only: str, cells: list[int] | None = None, profile: Path | None = None) -> Iterator[Frames]:
    """Yield the frames of each live view of the lessons whose names contain `only`."""
    assert find_browser(), "Chromium or Chrome is needed"
    with opened_lab() as lab:
        page = lab.browser.new_page(viewport={"width": 1280, "height": 720})
        page.set_default_timeout(120_000)
        page.add_init_script(COUNT_PICTURES)
        for path in lessons():
            if only in path.stem:
                folder = lab.student_folder(path.stem)
                notebook = Notebook(page, lab.address, folder, path.name)
                yield from views(notebook, path.stem, cells, profile)
                notebook.end()


def views(notebook: Notebook, lesson: str, cells: list[int] | None, profile: Path | None) -> Iterator[Frames]:
    """Run a lesson, and count the frames of each view whose nodes run live."""
    script = """async index => {
        const { content, sessionContext } = courseNotebook();
        const cell = content.widgets[index];
        if (!cell) return "end";
        if (cell.model.type !== "code") return "";
        await cell.constructor.execute(cell, sessionContext);
        return cell.model.sharedModel.getSource().trim(); }"""
    index = -1
    while (source := notebook.page.evaluate(script, index := index + 1)) != "end":
        last_line = source.split("\n")[-1].removesuffix(".beside()")
        if not last_line.isidentifier() or (cells and index not in cells):
            continue
        if notebook.kernel(RUNNING).strip() == "0":
            continue
        cell = notebook.cell(index)
        try:
            cell.locator("canvas:visible, .course-elsewhere:visible").first.wait_for(timeout=10_000)
        except NotShown:
            continue
        view = view_of(cell)
        view.scroll_into_view_if_needed()
        yield frames(notebook, view, lesson, index, profile)


def frames(notebook: Notebook, view: Locator, lesson: str, cell: int, profile: Path | None) -> Frames:
    """Count the frames of a view at rest and while it is turned."""
    page = notebook.page
    page.wait_for_timeout(1000 * WARM)
    still, used_still = count(page, profile and profile / f"{lesson}_{cell}_still")
    view.evaluate(TURN)
    page.wait_for_timeout(1000 * WARM)
    turned, used = count(page, profile and profile / f"{lesson}_{cell}")
    view.evaluate("canvas => { canvas.rests = true; }")
    rates = (turned, still, used["browser"], used["kernel"], used_still["browser"], used_still["kernel"])
    return Frames(lesson, cell, *rates, os.getloadavg()[0])


def count(page: Page, profile: Path | None) -> tuple[float, dict[str, float]]:
    """Count the pictures per second of a page, and the CPU of the browser and the kernels, in cores."""
    session: Any = None
    if profile:
        session = page.context.new_cdp_session(page)
        session.send("Profiler.enable")
        session.send("Profiler.start")
    me = psutil.Process()
    before, start = cpu(me), time.perf_counter()
    pictures = rate(page, SECONDS)
    after, seconds = cpu(me), time.perf_counter() - start
    if profile:
        profile.parent.mkdir(exist_ok=True)
        taken = session.send("Profiler.stop")["profile"]
        profile.with_suffix(".cpuprofile").write_text(json.dumps(taken))
        page.screenshot(path=profile.with_suffix(".png"))
    return pictures, {name: (after[name] - before[name]) / seconds for name in after}


def rate(page: Page, seconds: float) -> float:
    """Count the drawn frames per second of the page's clock."""
    script = """async seconds => {
        const [before, start] = [pictures, performance.now()];
        await new Promise(done => setTimeout(done, 1000 * seconds));
        return (pictures - before) / (performance.now() - start) * 1000; }"""
    return float(page.evaluate(script, seconds))


def cpu(me: psutil.Process) -> dict[str, float]:
    """Return the CPU time that the browser and the kernels have used, in [s]."""
    used = {"browser": 0.0, "kernel": 0.0}
    for child in me.children(recursive=True):
        try:
            name = "kernel" if "ipykernel" in " ".join(child.cmdline()) else "browser"
            times = child.cpu_times()
        except psutil.NoSuchProcess:
            continue
        used[name] += times.user + times.system
    return used


if __name__ == "__main__":
    main()
