"""Frames of each lesson's live views in JupyterLab: `python -m tests.benchmarks.bench_lessons`.

The cells of a lesson run one by one. The view of each of them is dragged, as by a hand with a
mouse, so that each frame of the page draws a new picture, whether nodes run live or not. Software
draws, as in tests.
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
from math import nan
from pathlib import Path
from typing import Any

import psutil
from playwright.sync_api import Locator, Page
from playwright.sync_api import TimeoutError as NotShown

from course_lib.course.material import lessons_dir
from course_lib.viewer.renderer import find_browser
from tests.benchmarks.bench_viewer import COUNT_PICTURES
from tests.browser.fake_host import chromium
from tests.browser.jupyterlab import Lab, Notebook, course_lab, view_of

WARM = 1.5  # rotation time before counting starts [s], in which the level of detail is selected
SECONDS = 4.0  # [s] that frames are counted for
RUNNING = """
from course_lib.ros.graph.graph import current_graph
from course_lib.ros.time.driving import live_runs
print(len(live_runs(current_graph())))"""
# Moves the pointer once before each frame, as a page gets the events of a mouse; to and fro, so
# that the scene stays in sight.
TURN = """canvas => {
    const { left, top, width, height } = canvas.getBoundingClientRect();
    let [x, step] = [0, 4];
    const send = (type) => canvas.dispatchEvent(new PointerEvent(type, {
        pointerId: 1, button: 0, bubbles: true, cancelable: true,
        clientX: left + width / 2 + x, clientY: top + height / 2 + x / 8 }));
    const turn = () => {
        if (!canvas.isConnected || canvas.rests) return send("pointercancel");
        if (Math.abs(x += step) >= 160) step = -step;
        send("pointermove");
        requestAnimationFrame(turn);
    };
    canvas.rests = false;
    canvas.setPointerCapture = () => {};  // there is no pointer with this id
    send("pointerdown");
    requestAnimationFrame(turn);
}"""
# Keeps the rendered pixels per displayed pixel, the level of detail, when a picture of the scene is
# copied into a view. Only these pictures are copied in part.
KEEP_SCALE = """
    const copy = CanvasRenderingContext2D.prototype.drawImage;
    CanvasRenderingContext2D.prototype.drawImage = function (...all) {
        if (all.length === 9 && this.canvas.isConnected) globalThis.scale = all[3] / all[7];
        return copy.apply(this, all); };"""
PAUSE = """
from course_lib.ros.graph.graph import current_graph
from course_lib.ros.time import pace
pace.speed_of(current_graph()).is_paused = {}"""
HANDS_OFF = 0.6  # [s]
AT_REST = 2.5  # [s] after which a view that does not move has its highest quality


@dataclass(frozen=True, slots=True)
class Frames:
    """Counters of one live view.

    Args:
        lesson: The lesson's name.
        cell: Index of the cell.
        turned: Pictures per second while the view is turned.
        scale: Rendered pixels per displayed pixel, at the end of the rotation.
        still: Pictures per second while only the nodes change it, as a robot that moves alone; NaN
            without live nodes.
        browser: CPU of the browser while the view is turned, in cores.
        kernel: CPU of the kernel while the view is turned, in cores.
        browser_still: CPU of the browser while only the nodes change the view, in cores.
        kernel_still: CPU of the kernel at the same time, in cores.
        load: The machine's load in the last minute.
    """

    lesson: str
    cell: int
    turned: float
    scale: float
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
    parser.add_argument("--pictures", type=Path, help="write a picture per view at rest into this folder")
    options = parser.parse_args()
    counted = []
    for row in measured(options.only, options.cells, options.profile, options.pictures):
        counted.append(row)
        print(
            f"| {row.lesson} | {row.cell} | {row.turned:.1f} | {row.scale:.2f} | "
            f"{row.browser:.2f} | {row.kernel:.2f} | {row.still:.1f} | {row.browser_still:.2f} | "
            f"{row.kernel_still:.2f} | {row.load:.1f} |",
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


def measured(
    only: str,
    cells: list[int] | None = None,
    profile: Path | None = None,
    pictures: Path | None = None,
) -> Iterator[Frames]:
    """Yield the frames of each view of the lessons whose names contain `only`."""
    assert find_browser(), "Chromium or Chrome is needed"
    with opened_lab() as lab:
        page = lab.browser.new_page(viewport={"width": 1280, "height": 720})
        page.set_default_timeout(120_000)
        page.add_init_script(COUNT_PICTURES + KEEP_SCALE)
        for path in sorted(lessons_dir().glob("*.ipynb")):
            if only in path.stem:
                folder = lab.student_folder(path.stem)
                notebook = Notebook(page, lab.address, folder, path.name)
                yield from views(notebook, path.stem, cells, profile, pictures)
                notebook.end()


def views(
    notebook: Notebook,
    lesson: str,
    cells: list[int] | None,
    profile: Path | None,
    pictures: Path | None,
) -> Iterator[Frames]:
    """Run a lesson, and count the frames of each view."""
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
        is_live = notebook.kernel(RUNNING).strip() != "0"
        cell = notebook.cell(index)
        try:
            cell.locator("canvas:visible, .course-elsewhere:visible").first.wait_for(timeout=10_000)
        except NotShown:
            continue
        view = view_of(cell)
        view.scroll_into_view_if_needed()
        if pictures:
            keep_picture(notebook, pictures / f"{lesson}_{index:03d}.png")
        yield frames(notebook, view, lesson, index, profile, is_live=is_live)


def keep_picture(notebook: Notebook, path: Path) -> None:
    """Write a picture of the page while robot time stands still and the view has come to rest."""
    path.parent.mkdir(exist_ok=True)
    notebook.kernel(PAUSE.format(True))
    notebook.page.wait_for_timeout(1000 * AT_REST)
    notebook.page.screenshot(path=path)
    notebook.kernel(PAUSE.format(False))


def frames(
    notebook: Notebook,
    view: Locator,
    lesson: str,
    cell: int,
    profile: Path | None,
    *,
    is_live: bool,
) -> Frames:
    """Count the frames of a view at rest and while it is turned."""
    page = notebook.page
    page.wait_for_timeout(1000 * WARM)
    still, used_still = (nan, {"browser": nan, "kernel": nan})
    if is_live:
        still, used_still = count(page, profile and profile / f"{lesson}_{cell}_still")
    view.evaluate(TURN)
    page.wait_for_timeout(1000 * WARM)
    turned, used = count(page, profile and profile / f"{lesson}_{cell}")
    scale = float(page.evaluate("scale"))
    view.evaluate("canvas => { canvas.rests = true; }")
    rates = (
        turned,
        scale,
        still,
        used["browser"],
        used["kernel"],
        used_still["browser"],
        used_still["kernel"],
    )
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
