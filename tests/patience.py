"""Timeouts of tests: two servers take up to 60 s to start on two busy cores."""

import threading

PATIENCE = 120.0  # [s]


def join(thread: threading.Thread) -> None:
    """Wait for the end of a thread, and fail at the timeout."""
    thread.join(PATIENCE)
    assert not thread.is_alive(), f"the thread {thread.name} has not ended"
