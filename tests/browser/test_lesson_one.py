"""Lesson 1 as a student meets it: real JupyterLab, real Chromium."""

import os
from collections.abc import Iterator
from pathlib import Path

import psutil
import pytest
from playwright.sync_api import Locator

from tests.browser.jupyterlab import Lab, Notebook, opened, red_pixels, view_of
from tests.browser.waiting import A_FRAME, wait_until

pytestmark = [pytest.mark.browser, pytest.mark.slow]
SHOW, LIVE = "viewer.add(", "live = run_live(node)"
LISTENERS = "from course_lib.ros.graph.graph import current_graph; print(len(current_graph()._taps))"
ENOUGH = 800  # [px] of the cube
NOW = "from course_lib.ros.graph.graph import current_graph; print(current_graph().now_ns)"
# A view of jupyterlab_widgets polls for its model for 2 s; a busy machine makes the last pause
# long.
ONE_LONG_PAUSE = """
    const pause = Number(sessionStorage.getItem("pause")), wait = window.setTimeout;
    sessionStorage.removeItem("pause");
    if (pause) window.setTimeout = (f, ms, ...rest) => wait(f, ms === 100 ? pause : ms, ...rest);
"""
PICTURES = os.environ.get("COURSE_PICTURES")  # a folder: pictures for the README go there


@pytest.fixture(scope="module")
def lesson(lab: Lab) -> Iterator[Notebook]:
    with opened(lab, "week01_first_marker.ipynb") as notebook:
        yield notebook


@pytest.fixture
def running(lesson: Notebook) -> Notebook:
    """The lesson, run up to the node that runs live."""
    lesson.run_to(LIVE)
    return lesson


def wait_for_red(cell: Locator) -> None:
    """Wait for the red cube, which appears one second after the start."""
    view = view_of(cell)
    wait_until(lambda: red_pixels(view) > ENOUGH, cell.page, A_FRAME)


def test_cube_is_drawn_while_its_node_runs_live_and_the_next_cell_can_run(running: Notebook) -> None:
    wait_for_red(running.cell(SHOW))
    if PICTURES:
        running.page.screenshot(path=Path(PICTURES) / "week01_jupyterlab.png")
    now = int(running.kernel(NOW))
    wait_until(lambda: int(running.kernel(NOW)) > now, running.page)
    running.run_to("%ros2 topic list")
    assert "/visualization_marker\n" in "".join(str(output.get("text")) for output in running.outputs())


def test_view_in_a_second_cell_shows_the_same_scene(running: Notebook) -> None:
    running.cell(LIVE)
    wait_for_red(running.run_below("viewer"))


def test_scene_is_kept_after_a_page_reload_even_if_its_models_arrive_late(running: Notebook) -> None:
    wait_for_red(running.cell(SHOW))
    running.page.add_init_script(ONE_LONG_PAUSE)
    running.page.evaluate("jupyterapp.commands.execute('docmanager:save')")
    running.page.evaluate("sessionStorage.setItem('pause', '2100')")
    running.open()
    wait_for_red(running.cell(SHOW))
    running.cell(LIVE).get_by_role("button", name="Stop").wait_for()


def test_rerunning_a_cell_removes_the_listeners_of_its_previous_viewer(running: Notebook) -> None:
    view_of(running.cell(SHOW))
    before = running.kernel(LISTENERS)
    for _ in range(2):
        running.run_to(SHOW)
        view_of(running.cell(SHOW))
        wait_until(lambda: running.kernel(LISTENERS) == before, running.page)


def test_stop_button_stops_the_live_node(running: Notebook) -> None:
    cell = running.cell(LIVE)
    cell.get_by_text("running").wait_for()
    cell.get_by_role("button", name="Stop").click()
    cell.get_by_text("stopped").wait_for()
    stopped_at = running.kernel(NOW)
    running.page.wait_for_timeout(300)
    assert running.kernel(NOW) == stopped_at


def test_all_cells_run_without_an_error(running: Notebook) -> None:
    running.cell(LIVE)
    running.run_rest()
    assert running.errors() == []


def test_kernel_restart_leaves_no_process_running(running: Notebook) -> None:
    kernel = psutil.Process(int(running.kernel("import os; print(os.getpid())")))
    assert kernel.children(recursive=True) == []
    server = kernel.parent()
    running.page.evaluate("courseNotebook().context.sessionContext.session.kernel.restart()")
    running.wait_idle()
    assert not kernel.is_running()
    assert server is not None
    assert len(server.children(recursive=True)) == 1
