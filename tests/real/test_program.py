"""The process of a program under the real rclpy, as far as it works without rclpy."""

import ctypes
import os
import signal
from collections.abc import Iterator
from typing import Any

import pytest

from course_lib.real.child import program

CALLBACK = """
def nested():
    os.kill(os.getpid(), signal.SIGINT)
    for _ in range(1000):
        pass


def callback():
    nested()
    calls.append("complete")
    return 5
"""


@pytest.fixture(autouse=True)
def handler() -> Iterator[None]:
    before = signal.signal(signal.SIGINT, program.interrupt)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("kind", [ctypes.CFUNCTYPE, ctypes.PYFUNCTYPE])
def test_interrupt_in_a_callback_of_c_code_is_raised_after_it_returns(kind: Any) -> None:
    calls: list[str] = []
    names: dict[str, Any] = {"os": os, "signal": signal, "calls": calls}
    exec(compile(CALLBACK, program.CALLBACKS, "exec"), names)
    function = kind(ctypes.c_int)(names["callback"])
    for count in (1, 2):
        with pytest.raises(KeyboardInterrupt):
            calls.append(str(function()))
        assert calls == ["complete"] * count


def test_interrupt_elsewhere_is_raised_immediately() -> None:
    with pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)
