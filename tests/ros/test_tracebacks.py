import importlib
import threading
import time
from collections.abc import Callable
from typing import Any

import pytest

from course_lib.ros.tracebacks import is_importing

# The lock of a module that is being imported, which Python offers only here.
LOCKS: Any = vars(importlib)["_bootstrap"]


def wait_until(is_true: Callable[[], bool]) -> None:
    """Wait up to ten seconds for a state."""
    end = time.monotonic() + 10.0
    while not is_true():
        assert time.monotonic() < end
        time.sleep(0.001)


def test_only_a_thread_within_an_import_statement_is_importing() -> None:
    def work() -> None:
        with pytest.raises(ModuleNotFoundError):
            importlib.import_module("module_of_a_slow_library")
        is_done.acquire()

    is_done = threading.Lock()
    thread = threading.Thread(target=work)
    with is_done:
        with LOCKS._ModuleLockManager("module_of_a_slow_library"):
            thread.start()
            wait_until(lambda: is_importing(thread.ident or 0))
        wait_until(lambda: not is_importing(thread.ident or 0))
    thread.join(10.0)
    assert not thread.is_alive()
    assert not is_importing(0)
