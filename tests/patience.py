"""How long tests wait for a state that must come: two servers take 60 s to start on two busy cores."""

import threading

PATIENCE = 120.0  # [s]


def join(thread: threading.Thread) -> None:
    """Wait for the end of a thread, which must come."""
    thread.join(PATIENCE)
    assert not thread.is_alive(), f"the thread {thread.name} has not ended"
