"""Interrupts a run in this process that does not come to an end."""

import _thread
import ctypes
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from course_lib.ros.tracebacks import line_of_thread

AGAIN = 1.0  # [s] code that swallows an interrupt gets another one


class Watchdog:
    """Says whether it had to interrupt."""

    def __init__(self) -> None:
        self.barked = False
        self.line = ""  # that a thread started meanwhile was in
        self._over = threading.Event()
        self._older = set(threading.enumerate())

    def watch(self, seconds: float) -> None:
        """Interrupt after `seconds` of the wall clock, and again until the run is over."""
        while not self._over.wait(AGAIN if self.barked else seconds):
            self.barked = True
            for thread in set(threading.enumerate()) - self._older - {threading.current_thread()}:
                self.line = self.line or line_of_thread(thread.ident or 0)
                end = ctypes.py_object(SystemExit)
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident or 0), end)
            if hasattr(signal, "pthread_kill"):  # a real signal: it also ends a wait for a lock
                signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
            else:
                _thread.interrupt_main()

    def stop(self) -> None:
        """Watch no more."""
        self._over.set()


@contextmanager
def watchdog(seconds: float) -> Iterator[Watchdog]:
    """Raise KeyboardInterrupt in the main thread, and end threads started meanwhile, after so many [s]."""
    dog = Watchdog()
    thread = threading.Thread(target=dog.watch, args=(seconds,), daemon=True)
    thread.start()
    try:
        yield dog
    finally:
        dog.stop()
        thread.join()
