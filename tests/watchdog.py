"""Ends a worker that hangs outside Python, where pytest-timeout's signal is not handled, with all stacks.

pytest's own `faulthandler_timeout` starts and ends a thread for each test, which takes 1 ms of
processor time. More than half of the 13,000 tests take less than 10 ms.
"""

import faulthandler
import math
import time
from collections.abc import Generator

import pytest
from _pytest.faulthandler import fault_handler_stderr_fd_key

LIMIT = 900.0  # [s] for one test, after pytest-timeout's limit
RENEWED_EVERY = 60.0  # [s], by which a test may be ended earlier or later


class Watchdog:
    """A plugin that starts the time limit anew for a test if the last start is a minute ago."""

    def __init__(self) -> None:
        self._started = -math.inf

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(
        self, item: pytest.Item, nextitem: pytest.Item | None
    ) -> Generator[None, object, object]:
        """Keep the time limit between the tests of a file, and end it where a worker may wait."""
        if time.monotonic() - self._started >= RENEWED_EVERY:
            self._started = time.monotonic()
            stderr = item.config.stash[fault_handler_stderr_fd_key]
            faulthandler.dump_traceback_later(LIMIT, file=stderr, exit=True)
        try:
            return (yield)
        finally:
            if nextitem is None or nextitem.path != item.path:
                faulthandler.cancel_dump_traceback_later()
                self._started = -math.inf
