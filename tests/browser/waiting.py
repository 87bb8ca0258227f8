"""Waiting for what is meant: as short as it takes, and long enough for a machine that has much to do."""

import time
from collections.abc import Callable

from playwright.sync_api import Page

from tests.patience import PATIENCE

A_MOMENT = 0.05  # [s]
A_FRAME = 0.35  # [s], longer than a frame of `jupyterlab.SLOW_SCREEN`: to look at pixels sooner is of no use


def wait_until(ready: Callable[[], object], page: Page | None = None, every: float = A_MOMENT) -> None:
    """Wait until something is so, asking at an interval in [s]; a page that is given goes on meanwhile."""
    end = time.monotonic() + PATIENCE
    while not ready():
        assert time.monotonic() < end, "it did not become so"
        if page:
            page.wait_for_timeout(every * 1000)
        else:
            time.sleep(every)
