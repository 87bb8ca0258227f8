import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from course_lib.ros.graph.graph import Graph, use_graph
from course_lib.viewer.renderer import find_browser
from tests.browser.bench import Bench
from tests.browser.fake_host import Host, chromium
from tests.browser.jupyterlab import Lab, course_lab
from tests.patience import PATIENCE

PICTURES = os.environ.get("COURSE_PICTURES")  # a folder
expect.set_options(timeout=PATIENCE * 1000)


@pytest.fixture(scope="package")  # not longer: Playwright would keep its event loop in later tests
def browser() -> Iterator[Browser]:
    if find_browser() is None:
        pytest.skip("no Chromium or Chrome on this machine")
    with chromium() as running:
        yield running


@pytest.fixture(scope="package")  # not longer: Playwright would keep its event loop in later tests
def lab(browser: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Lab]:
    top = tmp_path_factory.mktemp("lab")
    with course_lab(top / "students", top / "home") as address:
        yield Lab(browser, top / "students", address)


@pytest.fixture(scope="module")
def one_page(browser: Browser) -> Iterator[Page]:
    """A page for all tests of a file: to load the viewer's script costs more than most of them."""
    page = browser.new_page()
    page.set_default_timeout(PATIENCE * 1000)
    yield page
    page.close()


@pytest.fixture
def host(one_page: Page, monkeypatch: pytest.MonkeyPatch) -> Iterator[Host]:
    one_page.set_viewport_size({"width": 800, "height": 600})
    one_page.mouse.move(0, 0)
    host = Host(one_page, monkeypatch)
    yield host
    host.leave()
    assert host.errors == []


@pytest.fixture
def bench(host: Host, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    monkeypatch.chdir(tmp_path)
    with use_graph(Graph()) as graph:
        made = Bench(host, graph)
        assert host.errors == []
        yield made
        if PICTURES:
            name = os.environ["PYTEST_CURRENT_TEST"].split("::")[1].split(" ")[0]
            host.page.screenshot(path=Path(PICTURES) / f"panels_{name}.png")
        made.viewer.close()
