"""Handling of Ctrl+C and SIGTERM: both shut the contexts down.

Ctrl+C also raises KeyboardInterrupt, as usual.
"""

import signal
import threading
from enum import IntFlag
from types import FrameType

from course_lib.ros.graph.graph import current_graph
from course_lib.ros.time.time_lock import (
    HiddenHandler,
    hidden_handlers,
    real_getsignal,
    real_signal,
    time_lock,
)
from rclpy.context import Contexts


class SignalHandlerOptions(IntFlag):
    """The signals to handle."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Install the handlers. Do nothing outside the main thread, where Python does not allow it."""
    contexts = current_graph().state(Contexts)
    contexts.handles_interrupts = SignalHandlerOptions.SIGINT in options
    contexts.replaced_handler = (time_lock.handlers() or {}).get(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread():
        return
    for option in (SignalHandlerOptions.SIGINT, SignalHandlerOptions.SIGTERM):
        number = signal.Signals[option.name or ""]
        if option in options and real_getsignal(number) is not _handle:
            hidden_handlers[number] = HiddenHandler(_handle, real_signal(number, _handle))


def uninstall_signal_handlers() -> None:
    """Restore the previous handlers, except where the program has replaced rclpy's handler."""
    current_graph().state(Contexts).handles_interrupts = False
    if threading.current_thread() is threading.main_thread():
        for number, hidden in hidden_handlers.items():
            if real_getsignal(number) is hidden.handler:
                real_signal(number, hidden.replaced)


def _handle(number: int, frame: FrameType | None) -> None:
    for context in current_graph().state(Contexts).initialized:
        context.invalidate()
    time_lock.record_signal()
    replaced = hidden_handlers[number].replaced
    if callable(replaced):
        replaced(number, frame)
