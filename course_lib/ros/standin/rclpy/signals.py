"""Handling of Ctrl+C and SIGTERM: both shut the contexts down.

Ctrl+C also raises KeyboardInterrupt, as usual.
"""

import signal
import threading
from enum import IntFlag
from types import FrameType
from typing import Any

from course_lib.ros.graph.graph import current_graph
from course_lib.ros.time.time_lock import real_getsignal, real_signal, time_lock
from rclpy.context import Contexts


class SignalHandlerOptions(IntFlag):
    """The signals to handle."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


# The handlers that were replaced, by signal number. A process has one set of handlers.
_former: dict[int, Any] = {}


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Install the handlers. Do nothing outside the main thread, where Python does not allow it."""
    current_graph().state(Contexts).handles_interrupts = SignalHandlerOptions.SIGINT in options
    if threading.current_thread() is not threading.main_thread():
        return
    for option in (SignalHandlerOptions.SIGINT, SignalHandlerOptions.SIGTERM):
        number = signal.Signals[option.name or ""]
        if option in options and real_getsignal(number) is not _handle:
            _former[number] = real_signal(number, _handle)


def uninstall_signal_handlers() -> None:
    """Restore the previous handlers, except where the program has replaced rclpy's handler."""
    current_graph().state(Contexts).handles_interrupts = False
    if threading.current_thread() is threading.main_thread():
        for number, former in _former.items():
            if real_getsignal(number) is _handle:
                real_signal(number, former)


def _handle(number: int, frame: FrameType | None) -> None:
    for context in current_graph().state(Contexts).initialized:
        context.invalidate()
    time_lock.record_signal()
    former = _former.get(number)
    if callable(former):
        former(number, frame)
