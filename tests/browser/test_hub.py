"""Lesson 1 on a real JupyterHub, through its proxy, with two users of one machine."""

import os
import subprocess
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from urllib.parse import urlencode

import pytest
from playwright.sync_api import Browser, Page, expect

from course_lib.course.student_folder import prepare
from tests.browser.hub import HURRIED, Hub, missing, running_hub
from tests.browser.jupyterlab import Notebook, red_pixels
from tests.browser.test_lesson_one import LIVE, SHOW, wait_for_red
from tests.browser.waiting import A_FRAME, wait_until
from tests.patience import PATIENCE

pytestmark = [pytest.mark.browser, pytest.mark.slow]
LESSON = "week01_first_marker.ipynb"
A_LOOK = 1.0  # [s] between two questions to a server, which work for it


@pytest.fixture(scope="module")
def hub(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Hub]:
    if missing():
        pytest.skip(f"a JupyterHub needs {', '.join(missing())}")
    with running_hub(browser, tmp_path_factory.mktemp("hub")) as running:
        yield running


@pytest.fixture(scope="module")
def repository(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that an instructor publishes for nbgitpuller, as described in docs/hub.md."""
    folder = tmp_path_factory.mktemp("git") / "robotics"
    prepare(folder)
    who = {f"GIT_{role}_{key}": "me@uni.org" for role in ("AUTHOR", "COMMITTER") for key in ("NAME", "EMAIL")}
    for command in ("init -q -b main", "add -A", "commit -q -m lessons"):
        subprocess.run(
            ["git", *command.split()], cwd=folder, env=os.environ | who, check=True, timeout=PATIENCE
        )
    return folder


@pytest.fixture(scope="module")
def ada(hub: Hub) -> Notebook:
    """A student whose folder was made on the hub, with lesson 1 open."""
    folder = hub.homes / "ada" / "my_course"
    prepare(folder)
    return Notebook(hub.logged_in("ada"), f"{hub.address}/user/ada/lab", folder, LESSON)


@pytest.fixture(scope="module")
def grace(hub: Hub, repository: Path) -> Notebook:
    """A student who has opened a link of nbgitpuller, and whose idle kernels are culled early."""
    link = {"repo": repository.as_uri(), "branch": "main", "urlpath": f"lab/tree/robotics/{LESSON}"}
    page = hub.logged_in(HURRIED)
    pulling = page.context.new_page()
    pulling.goto(f"{hub.address}/user/{HURRIED}/git-pull?{urlencode(link)}")
    pulling.wait_for_url(f"**/lab/tree/robotics/{LESSON}", wait_until="commit")
    pulling.close()
    return Notebook(page, f"{hub.address}/user/{HURRIED}/lab", hub.homes / HURRIED / "robotics", LESSON)


@pytest.fixture
def running(ada: Notebook) -> Notebook:
    """Return ada's notebook with its node running live, which an earlier test may have started."""
    if ada.kernel("print('live' in globals())").strip() != "True":
        ada.run_to(LIVE)
    return ada


def opened_tab(notebook: Notebook) -> Page:
    """Click on the link that `viewer.open()` shows."""
    notebook.cell(LIVE)
    cell = notebook.run_below("viewer.open()")
    with notebook.page.expect_popup() as popup:
        cell.get_by_role("link").click()
    return popup.value


def test_two_users_of_one_machine_open_lesson_one_in_their_own_folders(
    ada: Notebook, grace: Notebook
) -> None:
    for notebook in (grace, ada):  # her kernel would be ended if it waited for the other
        notebook.run_to(LIVE)
    for notebook in (ada, grace):
        wait_for_red(notebook.cell(SHOW))
        assert notebook.errors() == []
        where = "from course_lib.course.state import find_student_folder as find; print(find())"
        assert notebook.kernel(where).strip() == str(notebook.folder)


def test_viewer_opens_in_a_tab_through_the_hub_proxy(running: Notebook) -> None:
    tab = opened_tab(running)
    assert "/user/ada/proxy/" in tab.url
    view = tab.locator("canvas").first
    view.wait_for()
    wait_until(lambda: red_pixels(view) > 800, tab, A_FRAME)
    tab.close()


def test_lesson_one_runs_on_a_hub_with_rqt_and_checks(running: Notebook) -> None:
    running.cell(LIVE)
    running.run_rest()
    assert running.errors() == []
    expect(running.cell("%ros2 topic list")).to_contain_text("/visualization_marker")
    running.run_below("%rqt graph").locator(".rqt").first.wait_for()
    checked = running.run_below('from course_lib import check\ncheck("week01.red_cube", lambda stamp: None)')
    expect(checked).to_contain_text("checks passed")


def test_kernel_with_live_nodes_is_not_idle_and_is_culled_after_they_stop(hub: Hub, grace: Notebook) -> None:
    grace.run_to(LIVE)
    wait_for_red(grace.cell(SHOW))
    kernels = partial(hub.ask, HURRIED, "kernels")
    (kernel,) = kernels()
    wait_until(lambda: kernels()[0]["last_activity"] > kernel["last_activity"], grace.page, A_LOOK)
    grace.run_below("live.stop()")
    wait_until(lambda: kernels() == [], grace.page, A_LOOK)
    grace.page.get_by_text("No Kernel").first.wait_for()
    wait_for_red(grace.cell(SHOW))
    grace.page.close()


def test_on_a_hub_course_lab_refreshes_the_folder_and_starts_no_second_jupyterlab(ada: Notebook) -> None:
    ada.cell(LIVE)
    said = ada.run_below(f"!{sys.executable} -m course_lib lab").inner_text()
    assert "Open contents.md of it in JupyterLab." in said
    assert "http" not in said
