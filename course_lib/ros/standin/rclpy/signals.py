"""Ctrl+C and SIGTERM: both shut the contexts down; Ctrl+C also raises KeyboardInterrupt, as ever."""

import signal
import threading
from collections.abc import Callable
from enum import IntFlag
from types import FrameType
from typing import Any

from rclpy.impl.run import current_run


class SignalHandlerOptions(IntFlag):
    """Which signals are to be handled."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


_before: dict[int, Any] = {}  # the handlers that ours stand in front of; a process has one set of them


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Install the handlers; Python allows that in the main thread only, elsewhere nothing happens."""
    if threading.current_thread() is not threading.main_thread():
        return
    for option in (SignalHandlerOptions.SIGINT, SignalHandlerOptions.SIGTERM):
        number = signal.Signals[option.name or ""]
        if option in options and number not in _before:
            _before[number] = signal.signal(number, _handle)


def uninstall_signal_handlers() -> None:
    """Put the former handlers back."""
    if threading.current_thread() is threading.main_thread():
        while _before:
            signal.signal(*_before.popitem())


def _handle(number: int, frame: FrameType | None) -> None:
    for context in current_run().contexts:
        context.invalidate()
    former: Callable[[int, FrameType | None], Any] | Any = _before.get(number)
    if callable(former):
        former(number, frame)
