"""The process of a program under the real rclpy, as far as it works without rclpy."""

import ctypes
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from course_lib.real.child import program
from course_lib.real.environment import RealEnvironment
from course_lib.real.process import RealProcesses
from course_lib.ros.time import wall

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


def test_interrupt_while_python_starts_ends_it_without_a_traceback(tmp_path: Path) -> None:
    python, file, output = tmp_path / "python", tmp_path / "my_node.py", tmp_path / "stderr"
    # A shell that interrupts itself stands for the first lines of Python.
    python.write_text(f'#!/bin/sh\nkill -INT $$\nexec {sys.executable} "$@"\n')
    python.chmod(0o755)
    file.write_text("raise SystemExit(3)\n")
    with output.open("w") as stderr:
        programs = RealProcesses(RealEnvironment(python), tmp_path, [file], print, domain=1)
        programs.start(file, streams=(None, stderr))
        while programs.are_running():
            wall.sleep(0.01)
    assert programs.end(lambda: None) == 0
    assert output.read_text() == ""
