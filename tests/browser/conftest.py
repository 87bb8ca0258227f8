from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from course_lib.viewer.browser import find_browser
from tests.browser.fake_host import Host, chromium


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    if find_browser() is None:
        pytest.skip("no Chromium or Chrome on this machine")
    with chromium() as running:
        yield running


@pytest.fixture
def host(browser: Browser, monkeypatch: pytest.MonkeyPatch) -> Iterator[Host]:
    page = browser.new_page(viewport={"width": 800, "height": 600})
    host = Host(page, monkeypatch)
    yield host
    page.close()
    assert host.errors == []
