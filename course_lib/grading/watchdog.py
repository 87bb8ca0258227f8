"""Interrupts a run in this process that does not come to an end."""

import _thread
import threading
from collections.abc import Iterator
from contextlib import contextmanager

AGAIN_S = 1.0  # [s] code that swallows an interrupt gets another one


class Watchdog:
    """Says whether it had to interrupt."""

    def __init__(self) -> None:
        self.barked = False
        self._over = threading.Event()

    def watch(self, seconds: float) -> None:
        """Interrupt the main thread after `seconds` of the wall clock, and again until it stops."""
        while not self._over.wait(AGAIN_S if self.barked else seconds):
            self.barked = True
            _thread.interrupt_main()

    def stop(self) -> None:
        """Watch no more."""
        self._over.set()


@contextmanager
def watchdog(seconds: float) -> Iterator[Watchdog]:
    """Raise KeyboardInterrupt in the main thread if the block lasts longer than `seconds`, [s]."""
    dog = Watchdog()
    thread = threading.Thread(target=dog.watch, args=(seconds,), daemon=True)
    thread.start()
    try:
        yield dog
    finally:
        dog.stop()
        thread.join()
