"""Ctrl+C and SIGTERM: both shut the contexts down; Ctrl+C also raises KeyboardInterrupt, as ever."""

import signal
import threading
from enum import IntFlag
from types import FrameType
from typing import Any

from course_lib.ros.graph import current_graph
from course_lib.ros.own_signals import real_getsignal, real_signal
from rclpy.context import Contexts


class SignalHandlerOptions(IntFlag):
    """The signals that are to be handled."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


_former: dict[int, Any] = {}  # the handlers that ours stand in front of; a process has one set of them


def install_signal_handlers(options: SignalHandlerOptions = SignalHandlerOptions.ALL) -> None:
    """Install the handlers; Python allows that in the main thread only, elsewhere nothing happens."""
    if threading.current_thread() is not threading.main_thread():
        return
    for option in (SignalHandlerOptions.SIGINT, SignalHandlerOptions.SIGTERM):
        number = signal.Signals[option.name or ""]
        if option in options and real_getsignal(number) is not _handle:
            _former[number] = real_signal(number, _handle)


def uninstall_signal_handlers() -> None:
    """Put the former handlers back, where nobody has replaced ours."""
    if threading.current_thread() is threading.main_thread():
        for number, former in _former.items():
            if real_getsignal(number) is _handle:
                real_signal(number, former)


def _handle(number: int, frame: FrameType | None) -> None:
    for context in current_graph().part(Contexts).initialized:
        context.invalidate()
    former = _former.get(number)
    if callable(former):
        former(number, frame)
