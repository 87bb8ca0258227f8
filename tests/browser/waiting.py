"""Waits for conditions, with timeouts that are long enough for a busy machine."""

import time
from collections.abc import Callable
from typing import TypeVar

import numpy as np
from playwright.sync_api import Page

from tests.patience import PATIENCE

T = TypeVar("T")
READINGS = 15  # equal ones in a row, after which a picture is at rest
A_MOMENT = 0.05  # [s]
A_FRAME = 0.35  # [s], longer than a frame of `jupyterlab.SLOW_SCREEN`: to look at pixels sooner is of no use


def wait_until(ready: Callable[[], object], page: Page | None = None, every: float = A_MOMENT) -> None:
    """Wait until a condition holds, polling every `interval` [s]; `page` continues to run."""
    end = time.monotonic() + PATIENCE
    while not ready():
        assert time.monotonic() < end, "it did not become so"
        if page:
            page.wait_for_timeout(every * 1000)
        else:
            time.sleep(every)


def at_rest(read: Callable[[], T], page: Page | None = None) -> T:
    """Read pixels or a number until they stay the same, and no view of the page is busy.

    A view is busy from a change until the picture of the highest quality, which it draws 0.7 s
    after the last
    change: before that, many equal pictures of a lower quality may be seen.
    """
    end, last, count = time.monotonic() + PATIENCE, read(), 0
    while count < READINGS:
        assert time.monotonic() < end, "it did not come to rest"
        is_busy = page is not None and page.locator("canvas[aria-busy=true]").count() > 0
        following = read()
        is_equal = np.array_equal(np.asarray(following), np.asarray(last))
        count = count + 1 if is_equal and not is_busy else 0
        last = following
    return last
