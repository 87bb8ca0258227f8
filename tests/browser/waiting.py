"""Waiting for what is meant: as short as it takes, and long enough for a machine that has much to do."""

import time
from collections.abc import Callable

from playwright.sync_api import Page

from tests.patience import PATIENCE

A_MOMENT = 0.05  # [s]


def wait_until(ready: Callable[[], object], page: Page | None = None) -> None:
    """Wait until something is so; a page that is given goes on meanwhile."""
    end = time.monotonic() + PATIENCE
    while not ready():
        assert time.monotonic() < end, "it did not become so"
        if page:
            page.wait_for_timeout(A_MOMENT * 1000)
        else:
            time.sleep(A_MOMENT)
