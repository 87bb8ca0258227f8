"""Handlers of signals that programs set: a program in a thread of its own has its own ones."""

import signal
import threading
from typing import Any

from course_lib.ros.baton import baton

real_signal, real_getsignal = signal.signal, signal.getsignal


def set_handler(number: int, handler: Any) -> Any:
    """Set a handler as `signal.signal` does; of a program, the end of the run calls it, as Ctrl+C would."""
    handlers = baton.handlers()
    if handlers is None:
        return real_signal(number, handler)
    is_main = threading.current_thread() is threading.main_thread()
    before = real_signal(number, handler) if is_main else handlers.get(number, _default(number))
    handlers[number] = handler
    return before


def get_handler(number: int) -> Any:
    """Return a handler as `signal.getsignal` does."""
    handlers = baton.handlers()
    if handlers is None or threading.current_thread() is threading.main_thread():
        return real_getsignal(number)
    return handlers.get(number, _default(number))


def _default(number: int) -> Any:
    return signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
